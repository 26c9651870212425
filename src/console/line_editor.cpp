#include "meltscope/console/line_editor.hpp"

#include <histedit.h>

#include <sys/ioctl.h>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <cwchar>
#include <mutex>
#include <stdexcept>
#include <thread>

namespace meltscope {
namespace {

constexpr int history_length = 2000;
constexpr int status_interval = 250; ///< ms
constexpr std::size_t longest_line = 1 << 16;

// A signal handler can reach nothing but this: the end of a pipe that wakes the editor, and what came.
std::atomic<int> wake_descriptor{-1};
std::atomic<bool> interrupt_came{false}, resize_came{false};

void wake() {
    const int descriptor = wake_descriptor;
    if (descriptor >= 0 && write(descriptor, "", 1) < 0) {
        // a full pipe wakes just as well
    }
}

void on_signal(int signal) {
    const int error = errno;
    (signal == SIGINT ? interrupt_came : resize_came) = true;
    wake();
    errno = error;
}

/// Takes a signal while it lives.
class SignalTaken {
  public:
    explicit SignalTaken(int signal) : signal_(signal) {
        struct sigaction action = {};
        action.sa_handler = on_signal;
        sigemptyset(&action.sa_mask);
        action.sa_flags = SA_RESTART;
        sigaction(signal_, &action, &before_);
    }
    ~SignalTaken() { sigaction(signal_, &before_, nullptr); }
    SignalTaken(const SignalTaken&) = delete;
    SignalTaken& operator=(const SignalTaken&) = delete;

  private:
    int signal_;
    struct sigaction before_ {};
};

bool can_edit() {
    const char* term = std::getenv("TERM");
    return isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1 && term && *term &&
           std::strcmp(term, "dumb") != 0;
}

int terminal_columns() {
    winsize size{};
    return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

std::string common_beginning(const std::vector<std::string>& words) {
    std::string common = words.front();
    for (const std::string& word : words)
        common.resize(std::size_t(
            std::mismatch(common.begin(), common.end(), word.begin(), word.end()).first - common.begin()));
    return common;
}

} // namespace

std::filesystem::path history_file() {
    if (const char* state = std::getenv("XDG_STATE_HOME"); state && *state == '/')
        return std::filesystem::path(state) / "meltscope/history";
    if (const char* home = std::getenv("HOME"); home && *home == '/')
        return std::filesystem::path(home) / ".local/state/meltscope/history";
    return {};
}

class LineEditor::Worker {
  public:
    Worker(std::string prompt, std::filesystem::path history, Callbacks callbacks)
        : prompt_(std::move(prompt)), history_path_(std::move(history)), callbacks_(std::move(callbacks)),
          edits_(can_edit()), prompts_(isatty(STDIN_FILENO) == 1) {
        if (pipe2(wake_.data(), O_CLOEXEC | O_NONBLOCK) != 0)
            throw std::runtime_error("the prompt cannot make a pipe");
        if (edits_) {
            tcgetattr(STDIN_FILENO, &terminal_before_);
            wake_descriptor = wake_[1];
            interrupt_ = std::make_unique<SignalTaken>(SIGINT);
            resize_ = std::make_unique<SignalTaken>(SIGWINCH);
        }
        thread_ = std::thread([this] { edits_ ? edit_lines() : read_lines(); });
    }

    ~Worker() {
        ending_ = true;
        wake_up();
        thread_.join();
        interrupt_.reset();
        resize_.reset();
        if (edits_) {
            wake_descriptor = -1;
            tcsetattr(STDIN_FILENO, TCSADRAIN, &terminal_before_);
        }
        flush_output();
        close(wake_[0]);
        close(wake_[1]);
    }

    void print(const std::string& text) {
        {
            const std::lock_guard lock(mutex_);
            output_ += text;
            if (!text.ends_with('\n'))
                output_ += '\n';
        }
        if (edits_)
            wake_up();
        else
            flush_output();
    }

    bool edits() const { return edits_; }

  private:
    void wake_up() {
        if (write(wake_[1], "", 1) < 0) {
            // a full pipe wakes just as well
        }
    }

    void flush_output() {
        const std::lock_guard lock(mutex_);
        std::fputs(output_.c_str(), stdout);
        std::fflush(stdout);
        output_.clear();
    }

    /// Waits until a byte can be read or something else is to be done. False when the editor is to end.
    bool wait_for_input(bool& readable, int milliseconds) {
        std::array<pollfd, 2> watched{{{STDIN_FILENO, POLLIN, 0}, {wake_[0], POLLIN, 0}}};
        poll(watched.data(), watched.size(), milliseconds);
        std::array<char, 256> sink;
        while (read(wake_[0], sink.data(), sink.size()) > 0) {
        }
        readable = watched[0].revents != 0;
        return !ending_;
    }

    // Plain reading.

    void read_lines() {
        std::string line;
        bool too_long = false;
        show_prompt();
        for (;;) {
            bool readable = false;
            if (!wait_for_input(readable, -1))
                return;
            if (!readable)
                continue;
            std::array<char, 4096> bytes;
            const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
            if (count < 0 && errno == EINTR)
                continue;
            if (count <= 0)
                break;
            for (const char c : std::string_view(bytes.data(), std::size_t(count))) {
                if (c != '\n') {
                    too_long = too_long || line.size() >= longest_line;
                    if (!too_long)
                        line += c;
                    continue;
                }
                hand_over(too_long ? line.substr(0, 60) + "... (a line too long)" : line);
                line.clear();
                too_long = false;
                show_prompt();
            }
        }
        if (!line.empty())
            hand_over(line);
        if (callbacks_.end)
            callbacks_.end();
    }

    void show_prompt() {
        if (!prompts_)
            return;
        const std::lock_guard lock(mutex_);
        std::fputs(prompt_.c_str(), stdout);
        std::fflush(stdout);
    }

    void hand_over(const std::string& line) {
        if (callbacks_.line)
            callbacks_.line(line);
    }

    // Editing. Everything that touches the terminal happens on this thread, most of it from within
    // read_character.

    static Worker& of(EditLine* editor) {
        void* worker = nullptr;
        el_get(editor, EL_CLIENTDATA, &worker);
        return *static_cast<Worker*>(worker);
    }

    void edit_lines() {
        std::setlocale(LC_CTYPE, ""); // typed characters; numbers stay as they are
        editor_ = el_init("meltscope", stdin, stdout, stderr);
        if (!editor_) {
            read_lines();
            return;
        }
        el_set(editor_, EL_CLIENTDATA, this);
        el_set(editor_, EL_EDITOR, "emacs");
        el_set(editor_, EL_SIGNAL, 0);
        el_set(
            editor_, EL_PROMPT, +[](EditLine* e) { return of(e).prompt_.data(); });
        el_set(
            editor_, EL_RPROMPT, +[](EditLine* e) { return of(e).shown_status_.data(); });
        el_set(editor_, EL_GETCFN, &read_character);
        el_set(editor_, EL_ADDFN, "meltscope-complete", "complete", &complete);
        el_set(editor_, EL_ADDFN, "meltscope-interrupt", "drop the line, or pause", &drop_line);
        el_set(editor_, EL_ADDFN, "meltscope-end", "delete, or end the input", &delete_or_end);
        el_set(editor_, EL_BIND, "^I", "meltscope-complete", nullptr);
        el_set(editor_, EL_BIND, "^C", "meltscope-interrupt", nullptr);
        el_set(editor_, EL_BIND, "^D", "meltscope-end", nullptr);
        el_set(editor_, EL_BIND, "^R", "em-inc-search-prev", nullptr);
        el_set(editor_, EL_BIND, "^W", "ed-delete-prev-word", nullptr);
        // Keys come in their order: Ctrl-C as a key, not as a signal that overtakes what was typed before it.
        el_set(editor_, EL_SETTY, "-d", "-isig", nullptr);
        el_set(editor_, EL_ADDFN, "meltscope-suspend", "suspend the program", &suspend);
        el_set(editor_, EL_BIND, "^Z", "meltscope-suspend", nullptr);
        load_history();
        el_set(editor_, EL_HIST, history, history_);
        while (!ending_) {
            int count = 0;
            const char* text = el_gets(editor_, &count);
            if (!text || count <= 0)
                break;
            std::string line(text, std::size_t(count));
            while (line.ends_with('\n') || line.ends_with('\r'))
                line.pop_back();
            if (line.empty())
                continue;
            HistEvent event;
            history(history_, &event, H_ENTER, line.c_str());
            save_history(line);
            hand_over(line);
        }
        el_end(editor_);
        history_end(history_);
        if (!ending_ && callbacks_.end)
            callbacks_.end();
    }

    void load_history() {
        history_ = history_init();
        HistEvent event;
        history(history_, &event, H_SETSIZE, history_length);
        history(history_, &event, H_SETUNIQUE, 1);
        if (history_path_.empty())
            return;
        std::error_code unwritable; // then the history ends with the session
        std::filesystem::create_directories(history_path_.parent_path(), unwritable);
        if (std::FILE* file = std::fopen(history_path_.c_str(), "r")) {
            std::array<char, 4096> line;
            while (std::fgets(line.data(), int(line.size()), file)) {
                line[std::strcspn(line.data(), "\n")] = '\0';
                if (line[0])
                    history(history_, &event, H_ENTER, line.data());
            }
            std::fclose(file);
        }
    }

    /// Appends, so that sessions at the same time do not take each other's lines away.
    void save_history(const std::string& line) const {
        if (history_path_.empty())
            return;
        const int file = open(history_path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
        if (file < 0)
            return;
        const std::string row = line + "\n";
        if (write(file, row.data(), row.size()) < 0) {
            // a full disk costs the history, not the run
        }
        close(file);
    }

    /// Shows what was printed meanwhile above the line, and the line again.
    void show_output() {
        const std::lock_guard lock(mutex_);
        if (output_.empty())
            return;
        const LineInfo* line = el_line(editor_);
        // The line may have wrapped: begin at its first row.
        const auto typed = prompt_.size() + std::size_t(line->cursor - line->buffer);
        const std::size_t rows_up = typed / std::size_t(terminal_columns());
        std::fputs("\r", stdout);
        if (rows_up > 0)
            std::fprintf(stdout, "\033[%zuA", rows_up);
        std::fputs("\033[J", stdout);
        std::fputs(output_.c_str(), stdout);
        std::fflush(stdout);
        output_.clear();
        el_set(editor_, EL_REFRESH);
    }

    void update_status() {
        std::string status = callbacks_.status ? callbacks_.status() : std::string();
        const std::size_t room = std::size_t(terminal_columns());
        if (prompt_.size() + status.size() + 20 > room)
            status.clear();
        if (status == shown_status_)
            return;
        shown_status_ = status;
        el_set(editor_, EL_REFRESH);
    }

    static int read_character(EditLine* editor, wchar_t* character) {
        return of(editor).next_character(character);
    }

    int next_character(wchar_t* character) {
        std::mbstate_t state{};
        for (;;) {
            if (ending_)
                return 0;
            if (interrupt_came.exchange(false)) {
                *character = L'\003';
                return 1;
            }
            if (resize_came.exchange(false))
                el_resize(editor_);
            show_output();
            update_status();
            bool readable = false;
            if (!wait_for_input(readable, status_interval))
                return 0;
            if (!readable)
                continue;
            char byte = 0;
            const ssize_t count = read(STDIN_FILENO, &byte, 1);
            if (count < 0 && (errno == EINTR || errno == EAGAIN))
                continue;
            if (count <= 0)
                return 0;
            const std::size_t length = std::mbrtowc(character, &byte, 1, &state);
            if (length == std::size_t(-2)) // more bytes belong to it
                continue;
            if (length == std::size_t(-1)) { // no character of this locale
                state = {};
                *character = L'?';
            }
            return 1;
        }
    }

    static unsigned char drop_line(EditLine* editor, int) {
        const LineInfo* line = el_line(editor);
        Worker& worker = of(editor);
        if (line->lastchar == line->buffer) {
            if (worker.callbacks_.interrupt)
                worker.callbacks_.interrupt();
            return CC_REFRESH;
        }
        el_cursor(editor, int(line->lastchar - line->cursor));
        el_deletestr(editor, int(line->lastchar - line->buffer));
        return CC_REFRESH;
    }

    static unsigned char delete_or_end(EditLine* editor, int) {
        const LineInfo* line = el_line(editor);
        if (line->lastchar == line->buffer) {
            std::fputs("\n", stdout);
            return CC_EOF;
        }
        if (line->cursor < line->lastchar) {
            el_cursor(editor, 1);
            el_deletestr(editor, 1);
        }
        return CC_REFRESH;
    }

    static unsigned char suspend(EditLine* editor, int) {
        el_set(editor, EL_PREP_TERM, 0);
        kill(0, SIGTSTP);
        el_set(editor, EL_PREP_TERM, 1);
        return CC_REDISPLAY;
    }

    static unsigned char complete(EditLine* editor, int) {
        Worker& worker = of(editor);
        if (!worker.callbacks_.complete)
            return CC_ERROR;
        const LineInfo* info = el_line(editor);
        const std::string line(info->buffer, std::size_t(info->cursor - info->buffer));
        const std::vector<std::string> words = worker.callbacks_.complete(line);
        if (words.empty())
            return CC_REFRESH_BEEP;
        const std::size_t begin =
            line.find_last_of(" \t,") == std::string::npos ? 0 : line.find_last_of(" \t,") + 1;
        const std::string typed = line.substr(begin);
        const std::string common = common_beginning(words);
        if (words.size() == 1) {
            const std::string rest = common.substr(typed.size()) + (common.ends_with('/') ? "" : " ");
            return el_insertstr(editor, rest.c_str()) == 0 ? CC_REFRESH : CC_ERROR;
        }
        if (common.size() > typed.size())
            return el_insertstr(editor, common.substr(typed.size()).c_str()) == 0 ? CC_REFRESH : CC_ERROR;
        std::string list;
        for (const std::string& word : words)
            list += (list.empty() ? "" : "  ") + word;
        {
            const std::lock_guard lock(worker.mutex_);
            worker.output_ += list + '\n';
        }
        return CC_REFRESH;
    }

    std::string prompt_;
    std::filesystem::path history_path_;
    Callbacks callbacks_;
    bool edits_, prompts_;
    std::array<int, 2> wake_{-1, -1};
    std::atomic<bool> ending_{false};
    std::unique_ptr<SignalTaken> interrupt_, resize_;
    termios terminal_before_{};
    std::mutex mutex_; ///< for what follows, and standard output
    std::string output_;
    // Of the editor's thread.
    EditLine* editor_ = nullptr;
    History* history_ = nullptr;
    std::string shown_status_;
    std::thread thread_;
};

LineEditor::LineEditor(std::string prompt, std::filesystem::path history, Callbacks callbacks)
    : worker_(std::make_unique<Worker>(std::move(prompt), std::move(history), std::move(callbacks))) {}
LineEditor::~LineEditor() = default;

void LineEditor::print(const std::string& text) {
    worker_->print(text);
}

bool LineEditor::edits() const {
    return worker_->edits();
}

} // namespace meltscope
