#include "viz/process.hpp"

#include "viz/options.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <sstream>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

constexpr int pipe_in_child = 3;

}

std::optional<std::filesystem::path> find_program(const std::string& name) {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const std::filesystem::path candidate = std::filesystem::path(folder.empty() ? "." : folder) / name;
        std::error_code error;
        if (std::filesystem::is_regular_file(candidate, error) && access(candidate.c_str(), X_OK) == 0) {
            return std::filesystem::absolute(candidate);
        }
    }
    return std::nullopt;
}

Child::Child(std::vector<std::string> arguments, const std::filesystem::path& working_dir) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
        throw VizError(fmt::format("cannot start {}: no pipe ({})", arguments.at(0), std::strerror(errno)));
    }
    // Everything that allocates happens before the fork: another thread may hold the heap's lock.
    bool errors_on_pipe = true;
    std::vector<char*> argv;
    for (std::string& argument : arguments) {
        if (argument == pipe_word) {
            argument = std::to_string(pipe_in_child);
            errors_on_pipe = false;
        }
        argv.push_back(argument.data());
    }
    argv.push_back(nullptr);
    const std::string folder = working_dir.string();
    const pid_t parent = getpid();

    pid_ = fork();
    if (pid_ == 0) {
        setsid();
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent || (!folder.empty() && chdir(folder.c_str()) != 0)) {
            _exit(127);
        }
        dup2(ends[1], pipe_in_child);
        fcntl(pipe_in_child, F_SETFD, 0);
        const int null = open("/dev/null", O_RDWR);
        dup2(null, STDIN_FILENO);
        dup2(null, STDOUT_FILENO);
        dup2(errors_on_pipe ? pipe_in_child : null, STDERR_FILENO);
        // The run's other files are none of the child's business.
        close_range(errors_on_pipe ? pipe_in_child : pipe_in_child + 1, ~0U, 0);
        sigset_t none;
        sigemptyset(&none);
        sigprocmask(SIG_SETMASK, &none, nullptr);
        execv(argv[0], argv.data());
        _exit(127);
    }
    const int error = errno;
    close(ends[1]);
    read_end_ = ends[0];
    if (pid_ < 0) {
        close_pipe();
        throw VizError(fmt::format("cannot start {}: {}", arguments[0], std::strerror(error)));
    }
}

Child::~Child() {
    stop();
    close_pipe();
}

void Child::close_pipe() {
    if (read_end_ >= 0) {
        close(read_end_);
        read_end_ = -1;
    }
}

std::string Child::read_until(char stop_char, std::chrono::milliseconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    std::string text;
    while (text.find(stop_char) == std::string::npos) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
            deadline - std::chrono::steady_clock::now());
        pollfd waiting{read_end_, POLLIN, 0};
        const int ready = left.count() > 0 ? poll(&waiting, 1, static_cast<int>(left.count())) : 0;
        if (ready < 0 && errno == EINTR) {
            continue;
        }
        char byte = 0;
        if (ready <= 0 || read(read_end_, &byte, 1) != 1) {
            break;
        }
        text += byte;
    }
    return text;
}

std::string Child::read_all() {
    std::string text;
    char buffer[4096];
    for (;;) {
        const ssize_t count = read(read_end_, buffer, sizeof buffer);
        if (count < 0 && errno == EINTR) {
            continue;
        }
        if (count <= 0) {
            return text;
        }
        text.append(buffer, static_cast<std::size_t>(count));
    }
}

int Child::wait() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void Child::stop() {
    if (pid_ < 0) {
        return;
    }
    kill(pid_, SIGTERM);
    for (int i = 0; i < 100; ++i) {
        if (waitpid(pid_, nullptr, WNOHANG) != 0) {
            pid_ = -1;
            return;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    kill(pid_, SIGKILL);
    wait();
}

} // namespace meltscope::viz
