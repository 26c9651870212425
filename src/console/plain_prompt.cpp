#include "prompt.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

namespace meltscope {
namespace {

constexpr std::size_t longest_line = 1 << 16;
/// ms until a person is asked for the next line, if the last one got no answer.
constexpr int prompt_delay = 150;
/// Until a line that could not be taken is given again.
constexpr std::chrono::milliseconds retry_delay{20};

class PlainPrompt : public Prompt {
  public:
    PlainPrompt(std::string prompt, LineEditor::Callbacks callbacks)
        : prompt_(std::move(prompt)), callbacks_(std::move(callbacks)), person_(isatty(STDIN_FILENO) == 1) {
        if (person_)
            signals_.emplace(pipe_, false);
        thread_ = std::thread([this] { read_lines(); });
    }

    ~PlainPrompt() override {
        ending_ = true;
        pipe_.wake();
        thread_.join();
        if (asked_)
            to_terminal("\n");
    }

    void print(const std::string& text) override {
        const std::lock_guard lock(mutex_);
        const bool line_begun = std::exchange(asked_, false);
        to_terminal((line_begun ? "\n" : "") + text + (text.ends_with('\n') ? "" : "\n"));
        // Whoever has been asked already may be typing. Others are asked when no more answers come.
        if (line_begun)
            ask();
    }

  private:
    /// Needs the mutex.
    void ask() {
        if (!person_ || std::exchange(asked_, true))
            return;
        to_terminal(prompt_);
    }

    bool is_asked() {
        const std::lock_guard lock(mutex_);
        return asked_;
    }

    void read_lines() {
        bool first = true;
        for (;;) {
            const bool waits = !person_ || is_asked();
            const bool readable = wait_for_input(pipe_, first ? 0 : waits ? -1 : prompt_delay);
            first = false;
            if (ending_)
                return;
            if (signals_ && signals_->take_interrupt()) {
                {
                    const std::lock_guard lock(mutex_);
                    to_terminal("\n"); // the terminal has dropped what was typed
                    asked_ = false;
                }
                line_.clear();
                if (callbacks_.interrupt)
                    callbacks_.interrupt();
            } else if (!readable) {
                const std::lock_guard lock(mutex_);
                ask();
            } else if (!take_input()) {
                break;
            }
        }
        if (!line_.empty())
            hand_over();
        if (callbacks_.end)
            callbacks_.end();
    }

    /// False at the end of the input.
    bool take_input() {
        std::array<char, 4096> bytes;
        const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
        if (count < 0 && (errno == EINTR || errno == EAGAIN))
            return true;
        for (const char c : std::string_view(bytes.data(), count > 0 ? std::size_t(count) : 0))
            if (c == '\n')
                hand_over();
            else if (line_.size() < longest_line)
                line_ += c;
            else
                too_long_ = true;
        return count > 0;
    }

    void hand_over() {
        {
            const std::lock_guard lock(mutex_);
            asked_ = false;
        }
        if (std::exchange(too_long_, false))
            line_ = line_.substr(0, 60) + "... (a line too long)";
        const std::string line = std::exchange(line_, {});
        while (callbacks_.line && !callbacks_.line(line) && !person_ && !ending_)
            std::this_thread::sleep_for(retry_delay);
    }

    std::string prompt_;
    LineEditor::Callbacks callbacks_;
    bool person_;
    WakePipe pipe_;
    std::optional<TerminalSignals> signals_;
    std::atomic<bool> ending_{false};
    std::mutex mutex_;   ///< for what follows, and standard output
    bool asked_ = false; ///< the prompt stands at the end of the output
    // Of the reading thread.
    std::string line_;
    bool too_long_ = false;
    std::thread thread_;
};

} // namespace

std::unique_ptr<Prompt> make_plain_prompt(std::string prompt, LineEditor::Callbacks callbacks) {
    return std::make_unique<PlainPrompt>(std::move(prompt), std::move(callbacks));
}

} // namespace meltscope
