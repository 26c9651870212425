#include "viz/pipeline.hpp"

#include "viz/data_sets.hpp"
#include "viz/file_output.hpp"
#include "viz/frame_renderer.hpp"
#include "viz/movie.hpp"
#include "viz/saved_instant.hpp"
#include "viz/vtk_errors.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Number of a picture VIEW_NNNNNN.png; nothing for other names.
std::optional<int> frame_number(const std::filesystem::path& file) {
    const std::string stem = file.stem().string();
    const auto underscore = stem.rfind('_');
    int number = 0;
    if (underscore == std::string::npos || std::sscanf(stem.c_str() + underscore + 1, "%d", &number) != 1) {
        return std::nullopt;
    }
    return number;
}

} // namespace

class Pipeline::Worker {
  public:
    Worker(FileOptions files, RenderOptions render, Backend backend, BacklogPolicy backlog, Report warn,
           Report note)
        : options_(std::move(render)), files_(std::move(files)), backend_(backend), backlog_(backlog),
          warn_(std::move(warn)), note_(std::move(note)) {
        thread_ = std::thread([this] { work(); });
    }

    ~Worker() { finish(); }

    void resume_at(double time);
    void submit(std::shared_ptr<const Snapshot> snapshot, bool render, bool files);
    void submit_saved(std::shared_ptr<const Snapshot> head, std::filesystem::path surface_file);
    void write_image(std::shared_ptr<const Snapshot> snapshot, const std::string& view,
                     const std::filesystem::path& png);
    void wait_for_earlier_than(double time);
    void finish();

    PipelineStats stats() const {
        const std::lock_guard lock(mutex_);
        return stats_;
    }
    double seconds_to_finish() const {
        const std::lock_guard lock(mutex_);
        return longest_job_ * double(queue_.size());
    }
    RenderOptions options() const {
        const std::lock_guard lock(mutex_);
        return options_;
    }
    template <class Change>
    void change_options(Change change) {
        const std::lock_guard lock(mutex_);
        RenderOptions changed = options_;
        change(changed);
        validate(changed);
        options_ = std::move(changed);
    }

  private:
    /// A picture asked for by hand; the result or the reason against goes back.
    struct Single {
        std::string view;
        std::filesystem::path png;
        std::promise<void> done;
    };
    struct Job {
        std::shared_ptr<const Snapshot> snapshot;
        bool render = false;
        bool files = false;
        std::filesystem::path
            surface_file; ///< what the picture is made from instead of the snapshot's fields
        std::optional<Single> single;
        RenderOptions options; ///< as they were when it was queued
        std::vector<HistoryPoint> history;
    };

    void enqueue(Job job, std::unique_lock<std::mutex>& lock);
    void work();
    void process(Job& job);
    void write_files(const Instant& instant);
    void render_frames(const Job& job, const Instant& instant);
    void render_single(Job& job, const Instant& instant);
    FrameRenderer& renderer();
    void record_history(const Snapshot& snapshot);
    template <class Action>
    void guarded(bool& alive, const char* what, Action action);

    // Shared, under mutex_.
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Job> queue_;
    bool finishing_ = false;
    RenderOptions options_;
    PipelineStats stats_;
    double longest_job_ = 0.0; ///< s
    std::vector<HistoryPoint> history_;
    int next_frame_ = 0;

    // The viz thread's own.
    FileOutput files_;
    Backend backend_;
    BacklogPolicy backlog_;
    Report warn_;
    Report note_;
    std::unique_ptr<FrameRenderer> renderer_;
    std::shared_ptr<const Geometry> geometry_;
    bool pictures_alive_ = true;
    bool files_alive_ = true;
    std::thread thread_;
};

void Pipeline::Worker::resume_at(double time) {
    const std::lock_guard lock(mutex_);
    files_.resume_at(time);
    next_frame_ = 0;
    const auto folder = options_.run_dir / "frames";
    std::vector<std::filesystem::path> gone;
    std::error_code error;
    for (const auto& file : std::filesystem::directory_iterator(folder, error)) {
        const auto number = frame_number(file.path());
        if (!number || file.path().extension() != ".png") {
            continue;
        }
        if (png_time(file.path()).value_or(time) >= time) {
            gone.push_back(file.path());
        } else {
            next_frame_ = std::max(next_frame_, *number + 1);
        }
    }
    for (const auto& file : gone) {
        std::filesystem::remove(file, error);
        if (error) {
            throw VizError(fmt::format("cannot remove {}: {}", file.string(), error.message()));
        }
    }
    std::erase_if(history_, [time](const HistoryPoint& point) { return point.time >= time; });
}

void Pipeline::Worker::record_history(const Snapshot& snapshot) {
    if (history_.empty() || snapshot.time > history_.back().time) {
        history_.push_back(history_point(snapshot));
    }
}

void Pipeline::Worker::submit(std::shared_ptr<const Snapshot> snapshot, bool render, bool files) {
    if (!snapshot || (!render && !files)) {
        return;
    }
    std::unique_lock lock(mutex_);
    record_history(*snapshot);
    const auto full = [&] { return queue_.size() >= static_cast<std::size_t>(backlog_.capacity); };
    if (render && full() && backlog_.on_full == BacklogPolicy::OnFull::drop) {
        ++stats_.drops;
        render = false;
        if (!files) {
            return;
        }
    }
    Job job;
    job.snapshot = std::move(snapshot);
    job.render = render;
    job.files = files;
    enqueue(std::move(job), lock);
}

void Pipeline::Worker::submit_saved(std::shared_ptr<const Snapshot> head,
                                    std::filesystem::path surface_file) {
    std::unique_lock lock(mutex_);
    record_history(*head);
    Job job;
    job.snapshot = std::move(head);
    job.surface_file = std::move(surface_file);
    job.render = true;
    enqueue(std::move(job), lock);
}

void Pipeline::Worker::enqueue(Job job, std::unique_lock<std::mutex>& lock) {
    const auto has_room = [&] {
        return finishing_ || queue_.size() < static_cast<std::size_t>(backlog_.capacity);
    };
    if (!has_room()) {
        ++stats_.waits;
        const auto start = Clock::now();
        changed_.wait(lock, has_room);
        stats_.wait_seconds += seconds_since(start);
    }
    if (finishing_) {
        return;
    }
    job.options = options_;
    if (job.render || job.single) {
        job.history = history_;
    }
    queue_.push_back(std::move(job));
    changed_.notify_all();
}

void Pipeline::Worker::write_image(std::shared_ptr<const Snapshot> snapshot, const std::string& view,
                                   const std::filesystem::path& png) {
    RenderOptions asked = options();
    asked.views = {view};
    validate(asked);
    if (!snapshot) {
        throw VizError("there is no snapshot to make a picture of");
    }
    std::future<void> done;
    {
        std::unique_lock lock(mutex_);
        Job job;
        job.snapshot = std::move(snapshot);
        job.single.emplace();
        job.single->view = view;
        job.single->png = png;
        done = job.single->done.get_future();
        enqueue(std::move(job), lock);
    }
    try {
        done.get();
    } catch (const std::future_error&) {
        throw VizError("no picture: the run's pictures have ended");
    }
}

void Pipeline::Worker::wait_for_earlier_than(double time) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { // queued in the order of time
        return queue_.empty() || queue_.front().snapshot->time >= time;
    });
}

void Pipeline::Worker::finish() {
    {
        const std::lock_guard lock(mutex_);
        finishing_ = true;
        changed_.notify_all();
    }
    if (thread_.joinable()) {
        thread_.join();
    }
}

void Pipeline::Worker::work() {
    capture_vtk_errors();
    for (;;) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return finishing_ || !queue_.empty(); });
        if (queue_.empty()) {
            break;
        }
        // The job keeps its place until it is done: the capacity counts what is being worked on too.
        Job& job = queue_.front();
        lock.unlock();
        const auto start = Clock::now();
        process(job);
        Job finished;
        lock.lock();
        const double seconds = seconds_since(start);
        stats_.busy_seconds += seconds;
        longest_job_ = std::max(longest_job_, seconds);
        finished = std::move(queue_.front());
        queue_.pop_front();
        changed_.notify_all();
        lock.unlock();
    }
    renderer_.reset();
}

/// Runs one kind of output unless it has failed before; its first failure is told once and ends it.
template <class Action>
void Pipeline::Worker::guarded(bool& alive, const char* what, Action action) {
    if (!alive) {
        return;
    }
    std::string reason;
    try {
        take_vtk_error();
        action();
        reason = take_vtk_error();
    } catch (const std::exception& error) {
        reason = error.what();
    } catch (...) {
        reason = "unknown failure";
    }
    if (reason.empty()) {
        return;
    }
    alive = false;
    const std::string words = fmt::format("{}: {}; the run goes on without {}", what, reason, what);
    {
        const std::lock_guard lock(mutex_);
        stats_.failure += stats_.failure.empty() ? words : "\n" + words;
    }
    if (warn_) {
        try {
            warn_(words);
        } catch (...) {
            // The report is the last that can be done for a failure.
        }
    }
}

void Pipeline::Worker::process(Job& job) {
    Instant instant;
    bool prepared = false;
    const auto prepare = [&] {
        if (!prepared) {
            instant = job.surface_file.empty() ? make_instant(job.snapshot, geometry_)
                                               : read_surface_file(job.surface_file, *job.snapshot);
            prepared = true;
        }
    };
    if (job.files) {
        guarded(files_alive_, "data files", [&] {
            prepare();
            write_files(instant);
        });
    }
    if (job.render) {
        guarded(pictures_alive_, "pictures", [&] {
            prepare();
            render_frames(job, instant);
        });
    }
    if (job.single) {
        try {
            take_vtk_error();
            prepare();
            render_single(job, instant);
            if (const std::string error = take_vtk_error(); !error.empty()) {
                throw VizError(error);
            }
            job.single->done.set_value();
        } catch (...) {
            job.single->done.set_exception(std::current_exception());
        }
    }
}

void Pipeline::Worker::write_files(const Instant& instant) {
    const auto start = Clock::now();
    const int files = files_.write(instant);
    const std::lock_guard lock(mutex_);
    stats_.files += files;
    stats_.file_seconds += seconds_since(start);
}

FrameRenderer& Pipeline::Worker::renderer() {
    if (!renderer_) {
        renderer_ = std::make_unique<FrameRenderer>(backend_);
    }
    return *renderer_;
}

void Pipeline::Worker::render_frames(const Job& job, const Instant& instant) {
    const auto start = Clock::now();
    const auto folder = job.options.run_dir / "frames";
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
        throw VizError(fmt::format("cannot make the folder {}: {}", folder.string(), error.message()));
    }
    FrameRenderer& window = renderer();
    for (const std::string& view : job.options.views) {
        const auto image = window.render(instant, job.history, job.options, view);
        write_png(image, folder / fmt::format("{}_{:06}.png", view, next_frame_), job.snapshot->time);
        const std::lock_guard lock(mutex_);
        ++stats_.frames;
    }
    ++next_frame_;
    bool first = false;
    {
        const std::lock_guard lock(mutex_);
        stats_.render_seconds += seconds_since(start);
        first = stats_.window_class.empty();
        stats_.backend = window.backend();
        stats_.window_class = window.window_class();
        stats_.renderer = window.renderer_name();
    }
    if (first && note_) {
        note_(fmt::format("pictures: {} on {} ({})", window.window_class(), backend_name(window.backend()),
                          window.renderer_name()));
    }
}

void Pipeline::Worker::render_single(Job& job, const Instant& instant) {
    if (job.single->png.has_parent_path()) {
        std::error_code error;
        std::filesystem::create_directories(job.single->png.parent_path(), error);
    }
    const auto image = renderer().render(instant, job.history, job.options, job.single->view);
    write_png(image, job.single->png, job.snapshot->time);
}

Pipeline::Pipeline(FileOptions files, RenderOptions render, Backend backend, BacklogPolicy backlog,
                   Report warn, Report note) {
    validate(render);
    if (backlog.capacity < 1) {
        throw VizError(fmt::format("a queue of {} snapshots is not possible; it must hold at least 1",
                                   backlog.capacity));
    }
    worker_ = std::make_unique<Worker>(std::move(files), std::move(render), backend, backlog, std::move(warn),
                                       std::move(note));
}

Pipeline::~Pipeline() = default;

void Pipeline::resume_at(double time) {
    worker_->resume_at(time);
}

void Pipeline::submit(std::shared_ptr<const Snapshot> snapshot, bool render, bool files) {
    worker_->submit(std::move(snapshot), render, files);
}

void Pipeline::submit_saved(std::shared_ptr<const Snapshot> head, std::filesystem::path surface_file) {
    worker_->submit_saved(std::move(head), std::move(surface_file));
}

void Pipeline::write_image(std::shared_ptr<const Snapshot> snapshot, const std::string& view,
                           const std::filesystem::path& png) {
    worker_->write_image(std::move(snapshot), view, png);
}

void Pipeline::set_views(std::vector<std::string> views) {
    worker_->change_options([&](RenderOptions& options) { options.views = std::move(views); });
}

void Pipeline::set_field(std::string field) {
    worker_->change_options([&](RenderOptions& options) { options.field = std::move(field); });
}

void Pipeline::set_color_range(std::optional<std::array<double, 2>> range) {
    worker_->change_options([&](RenderOptions& options) { options.color_range = range; });
}

void Pipeline::set_colormap(std::string colormap) {
    worker_->change_options([&](RenderOptions& options) { options.colormap = std::move(colormap); });
}

void Pipeline::set_background(Background background) {
    worker_->change_options([&](RenderOptions& options) { options.background = background; });
}

RenderOptions Pipeline::render_options() const {
    return worker_->options();
}

void Pipeline::wait_for_earlier_than(double time) {
    worker_->wait_for_earlier_than(time);
}

double Pipeline::seconds_to_finish() const {
    return worker_->seconds_to_finish();
}

void Pipeline::finish() {
    worker_->finish();
}

PipelineStats Pipeline::stats() const {
    return worker_->stats();
}

} // namespace meltscope::viz
