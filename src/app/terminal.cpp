#include "terminal.hpp"

#include "text.hpp"

#include <fmt/format.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/basic_file_sink.h>

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <utility>
#include <vector>

namespace meltscope {
namespace {

constexpr std::chrono::milliseconds draw_interval{100};

std::size_t terminal_width() {
    winsize size{};
    const bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return known ? size.ws_col : 80;
}

/// A piece of the progress line; the least important ones go when the line is too long.
struct Part {
    std::string text;
    int importance;
};

std::vector<Part> parts_of(const Progress& p) {
    std::vector<Part> parts{{fmt::format("step {}", p.step), 5},
                            {fmt::format("t {}", in_si(p.time, "s")), 6}};
    if (p.dt > 0.0)
        parts.push_back({fmt::format("dt {}", in_si(p.dt, "s")), 1});
    if (p.particle_steps_per_second > 0.0)
        parts.push_back({fmt::format("{:.1f} M particle-steps/s", 1e-6 * p.particle_steps_per_second), 2});
    if (!p.pool.empty())
        parts.push_back({fmt::format("pool {}", p.pool), 3});
    if (p.seconds_left)
        parts.push_back({fmt::format("ETA {}", clock_time(*p.seconds_left)), 4});
    return parts;
}

std::string joined(const std::vector<Part>& parts) {
    std::string text;
    for (const Part& part : parts)
        text += fmt::format("{}{}", text.empty() ? "" : "  ", part.text);
    return text;
}

/// The parts that fit the width, behind a bar that takes what they leave.
std::string progress_line(const Progress& p, std::size_t width) {
    const double share = p.end > 0.0 ? std::clamp(p.time / p.end, 0.0, 1.0) : 0.0;
    constexpr std::size_t least_bar = 8, most_bar = 30, frame = 4; // "[", "] " and a free column at the end
    std::vector<Part> parts = parts_of(p);
    parts.insert(parts.begin(), {fmt::format("{:3.0f} %", 100.0 * share), 7});
    while (parts.size() > 1 && joined(parts).size() + least_bar + frame > width)
        parts.erase(std::min_element(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
            return a.importance < b.importance;
        }));
    const std::string text = joined(parts);
    if (text.size() + least_bar + frame > width)
        return text.substr(0, width > 0 ? width - 1 : 0);
    const std::size_t length = std::min(most_bar, width - frame - text.size());
    const auto filled = std::size_t(share * double(length));
    return fmt::format("[{:.<{}}] {}", std::string(filled, '#'), length, text);
}

} // namespace

Terminal::Terminal(Volume volume) : volume_(volume), is_terminal_(isatty(STDOUT_FILENO) == 1) {}

Terminal::~Terminal() {
    end_progress();
}

void Terminal::log_to(const std::filesystem::path& file, bool append) {
    try {
        auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string(), !append);
        log_ = std::make_shared<spdlog::logger>("meltscope", std::move(sink));
    } catch (const spdlog::spdlog_ex&) {
        throw std::runtime_error(fmt::format("cannot write the log {}", file.string()));
    }
    log_->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
    log_->flush_on(spdlog::level::info);
}

void Terminal::clear_progress_line() {
    if (shown_.empty())
        return;
    show(stdout, "\r\033[K");
    shown_.clear();
}

void Terminal::speak_through(std::function<void(const std::string&)> speak) {
    const std::lock_guard lock(mutex_);
    clear_progress_line();
    speak_ = std::move(speak);
}

void Terminal::print(std::FILE* stream, const std::string& text) {
    if (speak_) {
        speak_(text);
        return;
    }
    const std::string progress = shown_;
    clear_progress_line();
    show(stream, text + "\n");
    if (!progress.empty()) {
        show(stdout, progress);
        shown_ = progress;
    }
}

void Terminal::say(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (log_)
        log_->info(text);
    if (volume_ != Volume::quiet)
        print(stdout, text);
}

void Terminal::note(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (log_)
        log_->info(text);
    if (volume_ == Volume::verbose)
        print(stdout, text);
}

void Terminal::warn(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (log_)
        log_->warn(text);
    print(stderr, fmt::format("warning: {}", text));
}

void Terminal::error(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (log_)
        log_->error(text);
    print(stderr, fmt::format("error: {}", text));
}

bool Terminal::wants_progress() const {
    return is_terminal_ && !speak_ && volume_ != Volume::quiet &&
           std::chrono::steady_clock::now() >= next_draw_;
}

void Terminal::progress(const Progress& progress) {
    const std::lock_guard lock(mutex_);
    if (!wants_progress())
        return;
    next_draw_ = std::chrono::steady_clock::now() + draw_interval;
    clear_progress_line();
    shown_ = progress_line(progress, terminal_width());
    show(stdout, shown_);
}

void Terminal::output_reached(const Progress& progress, double peak_temperature) {
    const std::string line = fmt::format("{}  peak {:.0f} K", joined(parts_of(progress)), peak_temperature);
    const std::lock_guard lock(mutex_);
    if (log_)
        log_->info(line);
    if (volume_ == Volume::verbose || (volume_ == Volume::normal && !is_terminal_))
        print(stdout, line);
}

void Terminal::end_progress() {
    const std::lock_guard lock(mutex_);
    clear_progress_line();
}

} // namespace meltscope
