#include "line_history.hpp"
#include "prompt.hpp"

#include <fmt/format.h>

#include <histedit.h>

#include <sys/ioctl.h>

#include <termios.h>

#include <algorithm>
#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <cwchar>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace meltscope {
namespace {

constexpr int status_interval = 250; ///< ms
constexpr std::size_t room_to_type = 20;

bool can_edit() {
    const char* term = std::getenv("TERM");
    return isatty(STDIN_FILENO) == 1 && isatty(STDOUT_FILENO) == 1 && term && *term &&
           std::strcmp(term, "dumb") != 0;
}

std::size_t terminal_columns() {
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

/// Words in columns that fit the terminal, row by row.
std::string in_columns(const std::vector<std::string>& words) {
    std::size_t longest = 0;
    for (const std::string& word : words)
        longest = std::max(longest, word.size());
    const std::size_t width = longest + 2, per_row = std::max<std::size_t>(1, terminal_columns() / width);
    std::string text;
    for (std::size_t n = 0; n < words.size(); ++n) {
        const bool last = n + 1 == words.size() || (n + 1) % per_row == 0;
        text += last ? words[n] + "\n" : fmt::format("{:<{}}", words[n], width);
    }
    return text;
}

/// Everything that touches the terminal happens on the editor's thread, most of it from within
/// next_character.
class EditedPrompt : public Prompt {
  public:
    EditedPrompt(std::string prompt, std::filesystem::path history, LineEditor::Callbacks callbacks)
        : prompt_(std::move(prompt)), history_(std::move(history)), callbacks_(std::move(callbacks)) {
        tcgetattr(STDIN_FILENO, &terminal_before_);
        signals_.emplace(pipe_, true);
        thread_ = std::thread([this] { edit_lines(); });
    }

    ~EditedPrompt() override {
        ending_ = true;
        pipe_.wake();
        thread_.join();
        signals_.reset();
        tcsetattr(STDIN_FILENO, TCSADRAIN, &terminal_before_);
        to_terminal(output_);
    }

    void print(const std::string& text) override {
        {
            const std::lock_guard lock(mutex_);
            output_ += text;
            if (!text.ends_with('\n'))
                output_ += '\n';
        }
        pipe_.wake();
    }

  private:
    static EditedPrompt& of(EditLine* editor) {
        void* prompt = nullptr;
        el_get(editor, EL_CLIENTDATA, &prompt);
        return *static_cast<EditedPrompt*>(prompt);
    }

    void bind(const char* key, const char* name, const char* help,
              unsigned char (*function)(EditLine*, int)) {
        el_set(editor_, EL_ADDFN, name, help, function);
        el_set(editor_, EL_BIND, key, name, nullptr);
    }

    void edit_lines() {
        // For typed characters; numbers stay as they are. Without that locale the one of C is as before.
        static_cast<void>(std::setlocale(LC_CTYPE, ""));
        editor_ = el_init("meltscope", stdin, stdout, stderr);
        if (!editor_) {
            if (callbacks_.end)
                callbacks_.end();
            return;
        }
        set_up();
        while (!ending_) {
            // Before the prompt is drawn: el_gets does it only after, and until then the terminal acts on
            // Ctrl-D.
            el_set(editor_, EL_PREP_TERM, 1);
            // What was typed since the line before may have been echoed by the terminal; the editor reads and
            // shows it.
            to_terminal("\r\033[J");
            int count = 0;
            const char* text = el_gets(editor_, &count);
            if (!text || count <= 0)
                break;
            std::string line(text, std::size_t(count));
            while (line.ends_with('\n') || line.ends_with('\r'))
                line.pop_back();
            if (line.empty())
                continue;
            history_.add(line);
            if (callbacks_.line)
                callbacks_.line(line);
        }
        if (ending_)
            to_terminal(line_cleared()); // what comes after the prompt's end begins on a row of its own
        el_end(editor_);
        if (!ending_ && callbacks_.end)
            callbacks_.end();
    }

    void set_up() {
        el_set(editor_, EL_CLIENTDATA, this);
        el_set(editor_, EL_EDITOR, "emacs");
        el_set(editor_, EL_SIGNAL, 0);
        el_set(
            editor_, EL_PROMPT, +[](EditLine* e) { return of(e).prompt_.data(); });
        el_set(
            editor_, EL_RPROMPT, +[](EditLine* e) { return of(e).shown_status_.data(); });
        el_set(
            editor_, EL_GETCFN, +[](EditLine* e, wchar_t* c) { return of(e).next_character(c); });
        bind("^I", "meltscope-complete", "complete", &complete);
        bind("^C", "meltscope-interrupt", "drop the line, or pause", &drop_line);
        bind("^D", "meltscope-end", "delete, or end the input", &delete_or_end);
        bind("^Z", "meltscope-suspend", "suspend the program", &suspend);
        bind("^J", "meltscope-enter", "end the line", &enter);
        el_set(editor_, EL_BIND, "^R", "em-inc-search-prev", nullptr);
        el_set(editor_, EL_BIND, "^W", "ed-delete-prev-word", nullptr);
        // Keys come in their order: Ctrl-C as a key, not as a signal that overtakes what was typed before it.
        el_set(editor_, EL_SETTY, "-d", "-isig", nullptr);
        el_set(editor_, EL_HIST, history, history_.get());
    }

    /// Takes the terminal to the beginning of the line being typed, which may take several rows, and clears
    /// it.
    std::string line_cleared() const {
        const LineInfoW* line = el_wline(editor_);
        std::size_t typed = prompt_.size();
        for (const wchar_t* c = line->buffer; c < line->cursor; ++c)
            typed += std::size_t(std::max(0, wcwidth(*c)));
        const std::size_t rows_up = typed / columns_;
        return rows_up > 0 ? fmt::format("\r\033[{}A\033[J", rows_up) : "\r\033[J";
    }

    /// The line again. EL_REFRESH alone begins wherever the cursor stands.
    void redraw() {
        to_terminal(line_cleared());
        el_set(editor_, EL_REFRESH);
    }

    /// Shows what was printed meanwhile above the line, and the line again.
    void show_output() {
        const std::lock_guard lock(mutex_);
        if (output_.empty())
            return;
        to_terminal(line_cleared() + output_);
        output_.clear();
        el_set(editor_, EL_REFRESH);
    }

    void follow_size() {
        columns_ = terminal_columns(); // terminals wrap what they show anew
        to_terminal(line_cleared());
        el_resize(editor_);
        el_set(editor_, EL_REFRESH);
    }

    void update_status() {
        std::string status = callbacks_.status ? callbacks_.status() : std::string();
        if (prompt_.size() + status.size() + room_to_type > columns_)
            status.clear();
        if (status == shown_status_)
            return;
        shown_status_ = status;
        redraw();
    }

    int next_character(wchar_t* character) {
        std::mbstate_t state{};
        for (;;) {
            if (ending_)
                return 0;
            if (signals_->take_interrupt()) {
                *character = L'\003';
                return 1;
            }
            if (signals_->take_resize())
                follow_size();
            show_output();
            update_status();
            if (!wait_for_input(pipe_, status_interval))
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

    /// What stays on the screen of a line is what was typed.
    static unsigned char enter(EditLine* editor, int) {
        of(editor).shown_status_.clear();
        of(editor).redraw();
        el_push(editor, "\r"); // bound to the end of a line, as Enter comes as \n
        return CC_NORM;
    }

    static unsigned char drop_line(EditLine* editor, int) {
        const LineInfo* line = el_line(editor);
        if (line->lastchar == line->buffer) {
            if (const auto& interrupt = of(editor).callbacks_.interrupt)
                interrupt();
            return CC_REFRESH;
        }
        el_cursor(editor, int(line->lastchar - line->cursor));
        el_deletestr(editor, int(line->lastchar - line->buffer));
        return CC_REFRESH;
    }

    static unsigned char delete_or_end(EditLine* editor, int) {
        const LineInfo* line = el_line(editor);
        if (line->lastchar == line->buffer) {
            to_terminal("\n");
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
        EditedPrompt& prompt = of(editor);
        if (!prompt.callbacks_.complete)
            return CC_ERROR;
        const LineInfo* info = el_line(editor);
        const std::string line(info->buffer, std::size_t(info->cursor - info->buffer));
        const std::vector<std::string> words = prompt.callbacks_.complete(line);
        if (words.empty())
            return CC_REFRESH_BEEP;
        const std::size_t gap = line.find_last_of(" \t,");
        const std::string typed = gap == std::string::npos ? line : line.substr(gap + 1);
        const std::string common = common_beginning(words);
        std::string rest = common.substr(typed.size());
        if (words.size() == 1)
            rest += common.ends_with('/') ? "" : " ";
        if (!rest.empty())
            return el_insertstr(editor, rest.c_str()) == 0 ? CC_REFRESH : CC_ERROR;
        prompt.print(in_columns(words));
        return CC_REFRESH;
    }

    std::string prompt_;
    LineHistory history_;
    LineEditor::Callbacks callbacks_;
    WakePipe pipe_;
    std::atomic<bool> ending_{false};
    std::optional<TerminalSignals> signals_;
    termios terminal_before_{};
    std::mutex mutex_; ///< for what follows
    std::string output_;
    // Of the editor's thread.
    EditLine* editor_ = nullptr;
    std::string shown_status_;
    std::size_t columns_ = terminal_columns();
    std::thread thread_;
};

} // namespace

std::unique_ptr<Prompt> make_edited_prompt(std::string prompt, std::filesystem::path history,
                                           LineEditor::Callbacks callbacks) {
    if (!can_edit())
        return nullptr;
    return std::make_unique<EditedPrompt>(std::move(prompt), std::move(history), std::move(callbacks));
}

} // namespace meltscope
