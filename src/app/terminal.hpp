#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace spdlog {
class logger;
}

namespace meltscope {

/// Where a run stands, for people to look at.
struct Progress {
    double time = 0.0, end = 0.0; ///< s
    std::int64_t step = 0;
    double dt = 0.0;                        ///< s
    double particle_steps_per_second = 0.0; ///< 0: not known yet
    std::string pool;                       ///< size of the melt pool; empty without one
    std::optional<double> seconds_left;
};

/// All that a run shows on the terminal, and its log. May be called from any thread.
///
/// On a terminal the last line is the progress, and other lines move past above it; on a pipe there are plain
/// lines, one an output.
class Terminal {
  public:
    enum class Volume { quiet, normal, verbose };

    explicit Terminal(Volume volume);
    ~Terminal();
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    /// Writes the log to a file from now on; `append` keeps what is in it. Throws std::runtime_error.
    void log_to(const std::filesystem::path& file, bool append);

    /// From now on, what is shown goes through this, whole lines each, and no progress is drawn: for a prompt
    /// that owns the terminal. Empty: back to the terminal itself.
    void speak_through(std::function<void(const std::string&)> speak);

    /// To standard output and the log. Quiet: to the log alone.
    void say(const std::string& text);
    /// To the log alone. Verbose: to standard output, too.
    void note(const std::string& text);
    /// To standard error and the log, however quiet.
    void warn(const std::string& text);
    void error(const std::string& text);

    /// Draws the progress line, if there is a terminal, at most ten times a second.
    void progress(const Progress& progress);
    /// True if a call of progress() would draw now: saves making up what would not be shown.
    bool wants_progress() const;
    /// One line about an output: to the log, and, unless a terminal shows progress anyway, to standard
    /// output.
    void output_reached(const Progress& progress, double peak_temperature);
    /// Takes the progress line away.
    void end_progress();

  private:
    void print(std::FILE* stream, const std::string& text);
    void clear_progress_line();

    Volume volume_;
    bool is_terminal_;
    std::mutex mutex_;
    std::shared_ptr<spdlog::logger> log_;
    std::function<void(const std::string&)> speak_;
    std::string shown_; ///< the progress line on the screen
    std::chrono::steady_clock::time_point next_draw_;
};

} // namespace meltscope
