#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace meltscope::viz {

/// Where a program of that name lies on PATH.
std::optional<std::filesystem::path> find_program(const std::string& name);

/// A child process without a shell: its own session, killed when the thread that started it dies, standard
/// input and output on /dev/null, no other open files. Its standard error goes to a pipe, unless an argument
/// is pipe_word: then that is the pipe, and standard error goes to /dev/null too.
class Child {
  public:
    /// The word in `arguments` that stands for the number of the pipe's writing end in the child.
    static constexpr const char* pipe_word = "%PIPE%";

    /// Starts arguments[0] (a full path). Throws VizError if the system has no process or pipe to give.
    explicit Child(std::vector<std::string> arguments, const std::filesystem::path& working_dir = {});
    /// Ends the child and reaps it.
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// What the child writes to the pipe, until `stop` comes, it ends, or the time is over.
    std::string read_until(char stop, std::chrono::milliseconds timeout);
    /// What the child writes to the pipe until it closes it.
    std::string read_all();
    /// Waits for the end; the exit code, or 128 + signal.
    int wait();
    /// Asks it to end, insists after a second, and reaps it.
    void stop();
    pid_t id() const { return pid_; }

  private:
    void close_pipe();
    pid_t pid_ = -1;
    int read_end_ = -1;
};

} // namespace meltscope::viz
