#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <stdexcept>

namespace meltscope {

/// A pipe that wakes a thread from its poll(); to be written to from any thread, and from signal handlers.
class WakePipe {
  public:
    /// Throws std::runtime_error if there are no descriptors left.
    WakePipe() {
        if (pipe2(ends_.data(), O_CLOEXEC | O_NONBLOCK) != 0)
            throw std::runtime_error("a pipe cannot be made: too many files are open");
    }
    ~WakePipe() {
        close(ends_[0]);
        close(ends_[1]);
    }
    WakePipe(const WakePipe&) = delete;
    WakePipe& operator=(const WakePipe&) = delete;

    /// To be polled for POLLIN.
    int descriptor() const { return ends_[0]; }
    void wake() { wake(ends_[1]); }
    /// For a signal handler, which knows nothing but wake_end().
    static void wake(int wake_end) {
        if (write(wake_end, "", 1) < 0) {
            // a full pipe wakes just as well
        }
    }
    int wake_end() const { return ends_[1]; }
    /// To be called when poll() has returned.
    void drain() {
        std::array<char, 256> sink;
        while (read(ends_[0], sink.data(), sink.size()) > 0) {
        }
    }

  private:
    std::array<int, 2> ends_{-1, -1};
};

} // namespace meltscope
