#include "attach_socket.hpp"
#include "wake_pipe.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <sstream>
#include <thread>
#include <vector>

namespace meltscope {
namespace {

constexpr int status_every = 250; ///< ms

/// Lines with a letter before each.
std::string lettered(char letter, const std::string& text) {
    std::string result;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        result += letter + line + '\n';
    return result;
}

/// True for text that a person could have typed.
bool is_text(const std::string& line) {
    return std::none_of(line.begin(), line.end(), [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return (byte < 0x20 && c != '\t') || byte == 0x7f;
    });
}

} // namespace

class AttachServer::Worker {
  public:
    Worker(const std::filesystem::path& folder, Console& console)
        : console_(console), folder_(open_own_folder(folder)) {
        struct stat there {};
        if (fstatat(folder_.get(), socket_name, &there, AT_SYMLINK_NOFOLLOW) == 0) {
            if (!S_ISSOCK(there.st_mode))
                throw AttachError(fmt::format("{} is in the way", (folder / socket_name).string()));
        }
        unlinkat(folder_.get(), socket_in_the_making, 0);
        listening_ = Descriptor(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
        const sockaddr_un address = address_in(folder_, socket_in_the_making);
        // The mode of the socket becomes that of the file, so that it is never open to others. It gets its
        // name once it listens: whoever sees it can connect.
        if (!listening_ || fchmod(listening_.get(), 0600) != 0 ||
            bind(listening_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
            fchmodat(folder_.get(), socket_in_the_making, 0600, 0) != 0 || listen(listening_.get(), 8) != 0 ||
            renameat(folder_.get(), socket_in_the_making, folder_.get(), socket_name) != 0)
            throw AttachError(fmt::format("{}: {}", (folder / socket_name).string(), std::strerror(errno)));
        thread_ = std::thread([this] { serve(); });
    }

    ~Worker() {
        ending_ = true;
        pipe_.wake();
        thread_.join();
        unlinkat(folder_.get(), socket_name, 0);
    }

  private:
    /// What a client has not read yet. Shared with the solver's thread.
    struct Outbox {
        std::mutex mutex;
        std::string bytes;
        bool overflowed = false;

        void put(const std::string& text) {
            const std::lock_guard lock(mutex);
            overflowed = overflowed || bytes.size() + text.size() > most_unread_bytes;
            if (!overflowed)
                bytes += text;
        }
    };

    struct Client {
        Descriptor socket;
        std::shared_ptr<Outbox> outbox = std::make_shared<Outbox>();
        std::string inbox;
        Console::Id id = 0; ///< 0: has not said hello yet
        bool may_change = false;
        bool prompt = false;     ///< a person sits there
        std::string status_sent; ///< what its status line shows
        bool done = false;       ///< to be let go of
    };

    void serve() {
        while (!ending_) {
            std::vector<pollfd> watched{{listening_.get(), POLLIN, 0}, {pipe_.descriptor(), POLLIN, 0}};
            for (const Client& client : clients_) {
                const std::lock_guard lock(client.outbox->mutex);
                const short writes = client.outbox->bytes.empty() ? short(0) : short(POLLOUT);
                watched.push_back({client.socket.get(), short(POLLIN | writes), 0});
            }
            const bool prompts =
                std::any_of(clients_.begin(), clients_.end(), [](const Client& c) { return c.prompt; });
            if (poll(watched.data(), watched.size(), prompts ? status_every : -1) < 0 && errno != EINTR)
                break;
            pipe_.drain();
            show_status();
            for (std::size_t n = 2; n < watched.size(); ++n) {
                if (watched[n].revents & (POLLIN | POLLHUP | POLLERR))
                    receive(clients_[n - 2]);
                send_to(clients_[n - 2]);
            }
            drop_done();
            if (watched[0].revents & POLLIN)
                accept_client();
        }
        for (Client& client : clients_) {
            client.outbox->put("qthe run has ended\n");
            send_to(client);
            client.done = true;
        }
        drop_done();
    }

    /// Tells prompts where the run is, if they have read all that came before.
    void show_status() {
        const std::string status = console_.status_line();
        for (Client& client : clients_) {
            const std::lock_guard lock(client.outbox->mutex);
            if (!client.prompt || !client.outbox->bytes.empty() || client.status_sent == status)
                continue;
            client.outbox->bytes = fmt::format("s{}\n", status);
            client.status_sent = status;
        }
    }

    void accept_client() {
        Client client;
        client.socket = Descriptor(accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
        if (!client.socket) {
            poll(nullptr, 0, 50); // no descriptor is left: whoever knocks does so again at once
            return;
        }
        const uid_t user = peer_user(client.socket.get());
        if (user != geteuid() && user != 0)
            return;
        if (clients_.size() >= most_attached) {
            client.outbox->put("qthere are as many consoles attached as there may be\n");
            send_to(client);
            return;
        }
        clients_.push_back(std::move(client));
    }

    void receive(Client& client) {
        std::array<char, 4096> bytes;
        const ssize_t count = recv(client.socket.get(), bytes.data(), bytes.size(), 0);
        if (count < 0 && (errno == EAGAIN || errno == EINTR))
            return;
        if (count <= 0) {
            client.done = true;
            return;
        }
        client.inbox.append(bytes.data(), std::size_t(count));
        std::size_t end = 0;
        while (!client.done && (end = client.inbox.find('\n')) != std::string::npos) {
            std::string line = client.inbox.substr(0, end);
            client.inbox.erase(0, end + 1);
            if (line.ends_with('\r'))
                line.pop_back();
            if (line.size() > longest_attached_line)
                refuse(client, "the line is too long");
            else if (!is_text(line))
                refuse(client, "this is no text");
            else if (client.id == 0)
                greet(client, line);
            else if (!console_.say(client.id, line))
                refuse(client, "too many lines wait");
        }
        if (client.inbox.size() > longest_attached_line)
            refuse(client, "the line is too long");
    }

    void refuse(Client& client, const std::string& why) {
        client.outbox->put("q" + why + "\n");
        send_to(client);
        client.inbox.clear();
        client.done = true;
    }

    void greet(Client& client, const std::string& hello) {
        std::istringstream words(hello);
        std::string program, version, role, kind;
        words >> program >> version >> role >> kind;
        if (program != "meltscope" || version != "1" || (role != "write" && role != "watch") ||
            (kind != "prompt" && kind != "script")) {
            refuse(client, "this console speaks another language");
            return;
        }
        // One that has left has no say any more, though it is let go of only after this round.
        const bool taken = std::any_of(clients_.begin(), clients_.end(),
                                       [](const Client& c) { return c.may_change && !c.done; });
        client.may_change = role == "write" && !taken;
        client.outbox->put(role == "write" && taken ? "wanother console has the say; this one looks on\n"
                                                    : fmt::format("w{}\n", console_.status_line()));
        client.prompt = kind == "prompt";
        if (client.prompt)
            client.outbox->put(names_to_complete());
        Speaker speaker;
        speaker.waits = kind == "script";
        speaker.may_change = client.may_change;
        speaker.most_lines = 1000;
        const bool script = speaker.waits;
        speaker.answer = [outbox = client.outbox, this, script](const std::string& line, const Reply& reply) {
            if (line.empty() && !reply.text.empty())
                outbox->put(lettered('n', reply.text));
            else if (!line.empty() || script)
                outbox->put(lettered('r', (reply.ok ? "" : "error: ") + reply.text) +
                            (reply.ok ? "d\n" : "f\n"));
            pipe_.wake();
        };
        client.id = console_.open(std::move(speaker));
    }

    std::string names_to_complete() const {
        const CompletionNames names = console_.completion_names();
        std::string text;
        const auto add = [&](const char* kind, const std::vector<std::string>& words) {
            text += fmt::format("c{}", kind);
            for (const std::string& word : words)
                text += fmt::format(" {}", as_word(word));
            text += '\n';
        };
        add("parameters", names.parameters);
        add("fields", names.fields);
        add("lasers", names.lasers);
        add("materials", names.materials);
        return text;
    }

    void send_to(Client& client) {
        const std::lock_guard lock(client.outbox->mutex);
        std::string& bytes = client.outbox->bytes;
        while (!bytes.empty()) {
            const ssize_t count =
                send(client.socket.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
            if (count < 0 && errno == EINTR)
                continue;
            if (count < 0) {
                client.done = client.done || (errno != EAGAIN && errno != EWOULDBLOCK);
                break;
            }
            bytes.erase(0, std::size_t(count));
        }
        client.done = client.done || client.outbox->overflowed;
    }

    void drop_done() {
        std::erase_if(clients_, [this](const Client& client) {
            if (client.done && client.id != 0)
                console_.close(client.id);
            return client.done;
        });
    }

    Console& console_;
    Descriptor folder_, listening_;
    WakePipe pipe_;
    std::atomic<bool> ending_{false};
    std::vector<Client> clients_; ///< of the server's thread
    std::thread thread_;
};

AttachServer::AttachServer(const std::filesystem::path& folder, Console& console)
    : worker_(std::make_unique<Worker>(folder, console)) {}
AttachServer::~AttachServer() = default;

} // namespace meltscope
