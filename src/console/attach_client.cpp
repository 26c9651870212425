#include "attach_socket.hpp"

#include "meltscope/console/commands.hpp"
#include "meltscope/console/line_editor.hpp"

#include <array>
#include <condition_variable>
#include <mutex>

namespace meltscope {
namespace {

/// Lines of a script that may be under way to the run, which lets no more than a thousand wait.
constexpr std::int64_t most_unanswered = 500;

Descriptor connect_to(const std::filesystem::path& folder) {
    const Descriptor opened = open_own_folder(folder);
    Descriptor connection(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const sockaddr_un address = address_in(opened);
    if (!connection ||
        connect(connection.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
        throw AttachError(errno == ENOENT || errno == ECONNREFUSED
                              ? fmt::format("no run is under way in {}", folder.string())
                              : fmt::format("{}: {}", folder.string(), std::strerror(errno)));
    if (peer_user(connection.get()) != geteuid())
        throw AttachError(fmt::format("the run in {} is another user's", folder.string()));
    return connection;
}

bool send_all(int connection, const std::string& text) {
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t count = send(connection, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
        if (count < 0 && errno == EINTR)
            continue;
        if (count <= 0)
            return false;
        sent += std::size_t(count);
    }
    return true;
}

/// Is it the command that ends this end of the connection, whole or begun? What is no command at all the run
/// will say.
bool is_detach(const std::string& text) {
    try {
        const std::vector<std::string> words = split_words(text);
        return words.size() == 1 && find_command(words[0]).name == "detach";
    } catch (const CommandError&) {
        return false;
    }
}

/// Lines as they come; false at the end.
class LineReader {
  public:
    explicit LineReader(int connection) : connection_(connection) {}

    bool next(std::string& line) {
        std::size_t end = 0;
        while ((end = buffer_.find('\n')) == std::string::npos) {
            std::array<char, 4096> bytes;
            const ssize_t count = recv(connection_, bytes.data(), bytes.size(), 0);
            if (count < 0 && errno == EINTR)
                continue;
            if (count <= 0)
                return false;
            buffer_.append(bytes.data(), std::size_t(count));
        }
        line = buffer_.substr(0, end);
        buffer_.erase(0, end + 1);
        return true;
    }

  private:
    int connection_;
    std::string buffer_;
};

/// Takes up `KIND WORD...` as the server sends it for completion.
void take_names(const std::string& text, CompletionNames& names) {
    std::vector<std::string> words = split_words(text);
    if (words.empty())
        return;
    const std::string kind = words.front();
    words.erase(words.begin());
    if (kind == "parameters")
        names.parameters = std::move(words);
    else if (kind == "fields")
        names.fields = std::move(words);
    else if (kind == "lasers")
        names.lasers = std::move(words);
    else if (kind == "materials")
        names.materials = std::move(words);
}

} // namespace

bool attach(const std::filesystem::path& folder, bool watch) {
    const Descriptor connection = connect_to(folder);
    const bool script = isatty(STDIN_FILENO) != 1;
    send_all(connection.get(),
             fmt::format("meltscope 1 {} {}\n", watch ? "watch" : "write", script ? "script" : "prompt"));
    LineReader reader(connection.get());
    std::string line;
    if (!reader.next(line))
        throw AttachError(fmt::format("the run in {} does not answer", folder.string()));
    if (line.starts_with('q'))
        throw AttachError(line.substr(1));

    std::mutex mutex;
    std::int64_t asked = 0, answered = 0;
    bool all_said = false, failed = false, interrupted = false;
    CompletionNames names;
    std::string status;
    const auto leave = [&] {
        const std::lock_guard lock(mutex);
        all_said = true;
        if (!script || answered == asked)
            shutdown(connection.get(), SHUT_RDWR);
    };
    LineEditor::Callbacks callbacks;
    callbacks.line = [&](const std::string& text) {
        if (!script && is_detach(text)) {
            leave();
            return true;
        }
        {
            const std::lock_guard lock(mutex);
            if (script && asked - answered >= most_unanswered)
                return false;
            ++asked;
            interrupted = false;
        }
        send_all(connection.get(), text + "\n");
        return true;
    };
    callbacks.interrupt = [&] {
        const bool again = std::exchange(interrupted, true);
        send_all(connection.get(), again ? "quit\n" : "pause\n");
    };
    callbacks.end = leave;
    callbacks.complete = [&](std::string_view typed) {
        const std::lock_guard lock(mutex);
        return completions(typed, names);
    };
    callbacks.status = [&] {
        const std::lock_guard lock(mutex);
        return status;
    };
    LineEditor editor("meltscope> ", history_file(), std::move(callbacks));
    do {
        const std::string text = line.empty() ? line : line.substr(1);
        const char letter = line.empty() ? ' ' : line[0];
        if (letter == 'd' || letter == 'f') {
            const std::lock_guard lock(mutex);
            ++answered;
            failed = failed || letter == 'f';
            if (script && all_said && answered == asked)
                break;
        } else if (letter == 'c') {
            const std::lock_guard lock(mutex);
            take_names(text, names);
        } else if (letter == 's') {
            const std::lock_guard lock(mutex);
            status = text;
        } else {
            editor.print(text);
        }
        if (letter == 'q')
            break;
    } while (reader.next(line));
    return !script || !failed;
}

} // namespace meltscope
