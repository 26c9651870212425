#include "prompt.hpp"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <utility>

namespace meltscope {
namespace {

std::atomic<int> wake_end{-1};
std::atomic<bool> interrupt_came{false}, resize_came{false};

void on_signal(int signal) {
    const int error = errno;
    (signal == SIGINT ? interrupt_came : resize_came) = true;
    WakePipe::wake(wake_end);
    errno = error;
}

} // namespace

struct TerminalSignals::Before {
    bool resizes = false;
    struct sigaction interrupt {
    }, resize{};
};

TerminalSignals::TerminalSignals(const WakePipe& pipe, bool resizes) : before_(std::make_unique<Before>()) {
    wake_end = pipe.wake_end();
    struct sigaction action = {};
    action.sa_handler = on_signal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    before_->resizes = resizes;
    sigaction(SIGINT, &action, &before_->interrupt);
    if (resizes)
        sigaction(SIGWINCH, &action, &before_->resize);
}

TerminalSignals::~TerminalSignals() {
    sigaction(SIGINT, &before_->interrupt, nullptr);
    if (before_->resizes)
        sigaction(SIGWINCH, &before_->resize, nullptr);
    wake_end = -1;
}

bool TerminalSignals::take_interrupt() {
    return interrupt_came.exchange(false);
}

bool TerminalSignals::take_resize() {
    return resize_came.exchange(false);
}

void to_terminal(const std::string& text) {
    static_cast<void>(std::fputs(text.c_str(), stdout));
    static_cast<void>(std::fflush(stdout));
}

bool wait_for_input(WakePipe& pipe, int milliseconds) {
    std::array<pollfd, 2> watched{{{STDIN_FILENO, POLLIN, 0}, {pipe.descriptor(), POLLIN, 0}}};
    const int ready = poll(watched.data(), watched.size(), milliseconds);
    pipe.drain();
    return ready > 0 && watched[0].revents != 0;
}

LineEditor::LineEditor(std::string prompt, std::filesystem::path history, Callbacks callbacks)
    : prompt_(make_edited_prompt(prompt, std::move(history), callbacks)) {
    if (!prompt_)
        prompt_ = make_plain_prompt(std::move(prompt), std::move(callbacks));
}
LineEditor::~LineEditor() = default;

void LineEditor::print(const std::string& text) {
    prompt_->print(text);
}

} // namespace meltscope
