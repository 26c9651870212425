#include "signals.hpp"

#include <atomic>
#include <csignal>

namespace meltscope {
namespace {

// A signal handler can reach nothing but this. Atomic, since any thread may be interrupted by it, and the
// run's looks here.
std::atomic<int> stop_requested = 0;
std::atomic<bool> checkpoint_requested = false;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

void on_signal(int signal) {
    if (signal == SIGUSR1)
        checkpoint_requested = true;
    else
        stop_requested = signal;
}

} // namespace

void watch_signals() {
    struct sigaction action = {};
    action.sa_handler = on_signal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(SIGUSR1, &action, nullptr);
    action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    struct sigaction hangup = {};
    sigaction(SIGHUP, nullptr, &hangup);
    if (hangup.sa_handler != SIG_IGN) { // as nohup leaves it
        action.sa_flags = SA_RESTART;   // a terminal that goes away and its shell both send one
        sigaction(SIGHUP, &action, nullptr);
    }
    struct sigaction ignore = {};
    ignore.sa_handler = SIG_IGN;
    // A reader of the output that goes away must not take the run along; a file too large for a quota is an
    // error of its writer, with a name.
    sigaction(SIGPIPE, &ignore, nullptr);
    sigaction(SIGXFSZ, &ignore, nullptr);
}

int stop_signal() {
    return stop_requested;
}

bool take_checkpoint_request() {
    return checkpoint_requested.exchange(false);
}

} // namespace meltscope
