#include "bench_insitu.hpp"

#include "stopwatch.hpp"

#include "meltscope/run/measure.hpp"
#include "viz/pipeline.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>
#include <thread>
#include <unistd.h>

namespace meltscope {
namespace {

constexpr int steps_between_outputs = 50;
constexpr int turns = 5;

/// A folder of this process alone, removed with all in it at the end.
struct TemporaryFolder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / fmt::format("meltscope_bench_{}", ::getpid());

    TemporaryFolder() { std::filesystem::create_directories(path); }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
};

void require_no_failure(const viz::PipelineStats& stats) {
    if (!stats.failure.empty())
        throw std::runtime_error(stats.failure);
}

/// Waits until so many pictures, each with its files, are there.
void wait_for_outputs(const viz::Pipeline& pipeline, std::int64_t outputs) {
    for (viz::PipelineStats stats = pipeline.stats(); stats.frames < outputs || stats.files < 3 * outputs;
         stats = pipeline.stats()) {
        require_no_failure(stats);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

/// Of one picture from a snapshot to its file, the solver at rest: median of a few.
double seconds_of_view(viz::Pipeline& pipeline, const std::shared_ptr<const Snapshot>& snapshot,
                       const std::string& view, const std::filesystem::path& folder) {
    std::vector<double> seconds;
    pipeline.write_image(snapshot, view, folder / "first.png"); // opens the view: once a run
    for (int turn = 0; turn < turns; ++turn) {
        const Stopwatch watch;
        pipeline.write_image(snapshot, view, folder / "picture.png");
        seconds.push_back(watch.seconds());
    }
    return median(seconds);
}

} // namespace

InSituCost measure_insitu_cost(Simulation& simulation) {
    const TemporaryFolder folder;
    viz::FileOptions files; // surface, pool and particles
    files.run_dir = folder.path;
    viz::RenderOptions render; // the overview
    render.run_dir = folder.path;
    viz::Pipeline pipeline(files, render, viz::Backend::automatic, {}, [](const std::string&) {});

    std::int64_t outputs = 0;
    std::vector<double> snapshots;
    const auto output = [&] {
        const Stopwatch watch;
        auto snapshot =
            std::make_shared<const Snapshot>(take_snapshot(simulation, ParticleSelection::surface));
        snapshots.push_back(watch.seconds());
        pipeline.submit(std::move(snapshot), true, true);
        ++outputs;
    };
    const auto step = [&] {
        for (int n = 0; n < steps_between_outputs; ++n)
            advance(simulation, simulation.parameters.time.end);
    };
    step(); // to have a pool
    output();
    wait_for_outputs(pipeline, outputs); // opens the window and the libraries: once a run
    const viz::PipelineStats before = pipeline.stats();
    std::vector<double> with, without;
    for (int turn = 0; turn < turns; ++turn) {
        const Stopwatch alone;
        step();
        without.push_back(alone.seconds());
        const Stopwatch accompanied;
        output();
        step();
        wait_for_outputs(pipeline, outputs);
        with.push_back(accompanied.seconds());
    }
    const viz::PipelineStats stats = pipeline.stats();
    InSituCost cost;
    const auto last = std::make_shared<const Snapshot>(take_snapshot(simulation, ParticleSelection::none));
    cost.overview_seconds = seconds_of_view(pipeline, last, "overview", folder.path);
    cost.dashboard_seconds = seconds_of_view(pipeline, last, "dashboard", folder.path);
    pipeline.finish();
    require_no_failure(pipeline.stats());
    cost.snapshot_seconds = median(snapshots);
    cost.steps = steps_between_outputs;
    cost.without_seconds = median(without);
    cost.with_seconds = median(with);
    cost.frames = stats.frames - before.frames;
    cost.files = stats.files - before.files;
    cost.render_seconds = (stats.render_seconds - before.render_seconds) / turns;
    cost.file_seconds = (stats.file_seconds - before.file_seconds) / turns;
    return cost;
}

} // namespace meltscope
