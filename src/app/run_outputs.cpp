#include "run_outputs.hpp"

#include "disk_need.hpp"
#include "text.hpp"

#include "meltscope/io/atomic_file.hpp"
#include "meltscope/io/run_state.hpp"
#include "meltscope/io/run_summary.hpp"
#include "meltscope/io/solidification_table.hpp"
#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/version.hpp"
#include "viz/movie.hpp"
#include "viz/solidification_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace meltscope {
namespace {

viz::BacklogPolicy backlog_policy(const RenderSpec& render) {
    viz::BacklogPolicy policy;
    policy.on_full = render.on_backlog == RenderSpec::OnBacklog::drop ? viz::BacklogPolicy::OnFull::drop
                                                                      : viz::BacklogPolicy::OnFull::wait;
    return policy;
}

} // namespace

viz::FileOptions file_options(const std::filesystem::path& folder, const OutputSpec& output) {
    viz::FileOptions options;
    options.run_dir = folder;
    options.surface = output.surface;
    options.pool = output.pool;
    options.grid = output.grid;
    options.particles = output.particles != OutputSpec::Particles::none;
    options.particles_as_vtu = output.particles_format == OutputSpec::ParticlesFormat::vtu;
    options.compression = output.compression == OutputSpec::Compression::lz4    ? viz::Compression::lz4
                          : output.compression == OutputSpec::Compression::zlib ? viz::Compression::zlib
                                                                                : viz::Compression::none;
    options.precision = output.precision == OutputSpec::Precision::float64 ? viz::Precision::float64
                                                                           : viz::Precision::float32;
    return options;
}

viz::RenderOptions render_options(const std::filesystem::path& folder, const RenderSpec& render) {
    viz::RenderOptions options;
    options.run_dir = folder;
    options.size = render.size;
    options.views = render.views;
    options.color_range = render.color_range;
    options.colormap = render.colormap;
    options.background =
        render.background == RenderSpec::Background::light ? viz::Background::light : viz::Background::dark;
    return options;
}

std::int64_t count_pictures(const RunPaths& paths, const std::string& view) {
    std::int64_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(paths.frames()))
        count += entry.path().filename().string().starts_with(view + "_");
    return count;
}

double movie_rate(std::int64_t pictures) {
    return std::clamp(double(pictures) / 6.0, 5.0, 25.0);
}

std::string pool_size(const Snapshot& snapshot) {
    if (snapshot.pools.empty() || snapshot.pools.front().volume <= 0.0)
        return {};
    const PoolFigures& pool = snapshot.pools.front();
    return fmt::format("{:.0f} x {:.0f} x {:.0f} um", 1e6 * pool.length, 1e6 * pool.width, 1e6 * pool.depth);
}

RunOutputs::RunOutputs(RunPaths paths, const PreparedRun& prepared, viz::Backend backend, int threads,
                       Terminal& terminal)
    : paths_(std::move(paths)), scenario_(prepared.scenario), scenario_text_(to_toml(prepared.scenario)),
      draws_(backend != viz::Backend::none && !prepared.scenario.render.views.empty()), threads_(threads),
      terminal_(terminal), backend_(backend), steps_at_start_(prepared.run.simulation.step) {
    open_files(prepared.run, prepared.resumed_at);
    if (!prepared.resumed_at || !std::filesystem::exists(paths_.scenario()))
        write_file_atomically(paths_.scenario(), scenario_text_);
    write_summary(prepared.run, "running", "");
}

void RunOutputs::open_files(const Run& run, std::optional<double> resume_at) {
    std::vector<std::string> lasers;
    for (const Laser& laser : run.simulation.parameters.lasers)
        lasers.push_back(laser.name);
    table_.emplace(paths_.melt_pool_table(), run.simulation.parameters.isotherms, lasers, resume_at);
    pools_table_.emplace(paths_.separate_pools_table(), resume_at);
    table_time_ = -1.0;
    if (resume_at)
        after_step(run); // the row of this instant has been dropped
    pipeline_.emplace(
        file_options(paths_.root, scenario_.output), render_options(paths_.root, scenario_.render), backend_,
        backlog_policy(scenario_.render), [this](const std::string& text) { terminal_.warn(text); },
        [this](const std::string& text) { terminal_.note(text); });
    if (!resume_at)
        return;
    pipeline_->resume_at(*resume_at);
    drop_checkpoints_after(paths_, run.simulation.step);
}

void RunOutputs::set_render(const RenderSettings& settings) {
    pipeline_->set_views(settings.views);
    pipeline_->set_field(settings.field);
    pipeline_->set_color_range(settings.color_range);
    pipeline_->set_colormap(settings.colormap);
    pipeline_->set_background(settings.background == "light" ? viz::Background::light
                                                             : viz::Background::dark);
}

void RunOutputs::write_picture(const Run& run, const std::string& view, const std::filesystem::path& png) {
    pipeline_->write_image(
        std::make_shared<const Snapshot>(take_snapshot(run.simulation, ParticleSelection::none)), view, png);
}

void RunOutputs::scenario_changed() {
    scenario_text_ = to_toml(scenario_);
}

void RunOutputs::restored(const Run& run) {
    const viz::RenderOptions shown = pipeline_->render_options();
    pipeline_->finish();
    open_files(run, run.simulation.time);
    pipeline_->set_views(shown.views);
    pipeline_->set_field(shown.field);
    pipeline_->set_color_range(shown.color_range);
    pipeline_->set_colormap(shown.colormap);
    pipeline_->set_background(shown.background);
}

void RunOutputs::require_folder() {
    if (std::filesystem::exists(paths_.scenario()))
        return;
    terminal_.warn(
        fmt::format("the run folder {} was removed during the run; it is made again, what was in it "
                    "is lost",
                    paths_.root.string()));
    std::filesystem::create_directories(paths_.root);
    write_file_atomically(paths_.scenario(), scenario_text_);
}

void RunOutputs::add_row(const Snapshot& snapshot) {
    if (snapshot.time == table_time_)
        return; // as the row of its step
    table_->append(snapshot);
    pools_table_->append(snapshot);
    table_time_ = snapshot.time;
}

void RunOutputs::after_step(const Run& run) {
    if (scenario_.output.pool_rows == OutputSpec::PoolRows::step)
        add_row(take_snapshot(run.simulation, ParticleSelection::none));
}

std::vector<Sink> RunOutputs::sinks() {
    const auto pictures_and_files = [this](const Run&, const Due& due,
                                           const std::shared_ptr<const Snapshot>& snapshot) {
        require_folder();
        pipeline_->submit(snapshot, due.picture && draws_, due.output);
    };
    const auto table = [this](const Run&, const Due& due, const std::shared_ptr<const Snapshot>& snapshot) {
        pool_ = pool_size(*snapshot);
        if (due.output)
            add_row(*snapshot);
    };
    const auto checkpoints = [this](const Run& run, const Due& due, const std::shared_ptr<const Snapshot>&) {
        if (due.checkpoint)
            write_checkpoint_of(run);
    };
    return {{Sink::Wants::snapshot, &WallSeconds::in_situ, pictures_and_files},
            {Sink::Wants::snapshot, &WallSeconds::output, table},
            {Sink::Wants::state, &WallSeconds::output, checkpoints}};
}

void RunOutputs::write_checkpoint_of(const Run& run) {
    // A restart makes nothing again that lies before it: a kill must not find a checkpoint ahead of the
    // files.
    pipeline_->wait_for_earlier_than(run.simulation.time);
    const auto path = paths_.checkpoint(run.simulation.step);
    std::filesystem::create_directory(path.parent_path()); // fails if the run folder has been removed
    const Stopwatch watch;
    write_checkpoint(path, checkpoint_of(run, scenario_text_));
    longest_checkpoint_ = std::max(longest_checkpoint_, watch.seconds());
    prune_checkpoints(paths_, scenario_.checkpoint.keep);
    last_checkpoint_ = path;
    terminal_.note(fmt::format("checkpoint {}", path.string()));
    write_summary(run, "running", "");
}

std::filesystem::path RunOutputs::keep_for_inspection(const Run& run) const {
    const auto path = paths_.inspection(run.simulation.step);
    write_checkpoint(path, checkpoint_of(run, scenario_text_));
    return path;
}

void RunOutputs::write_summary(const Run& run, const std::string& outcome, const std::string& message) const {
    const Simulation& simulation = run.simulation;
    const std::int64_t steps_made = simulation.step - steps_at_start_;
    RunSummary summary;
    summary.version = version;
    summary.git_hash = git_hash;
    summary.title = scenario_.title;
    summary.outcome = outcome;
    summary.message = message;
    summary.threads = threads_;
    summary.particles = simulation.particles.count();
    summary.steps = simulation.step;
    summary.time = simulation.time;
    summary.wall_seconds = {{"solver", run.wall.solver},
                            {"level_set", run.wall.level_set},
                            {"in_situ", run.wall.in_situ},
                            {"output", run.wall.output},
                            {"total", since_start_.seconds()}};
    if (steps_made > 0 && run.wall.solver > 0.0)
        summary.particle_steps_per_second = double(steps_made) * double(summary.particles) / run.wall.solver;
    summary.ledger = ledger_entries(simulation.ledger);
    summary.ledger.emplace_back("relative_residual", simulation.ledger.relative_residual());
    const viz::PipelineStats stats = pipeline_->stats();
    summary.rendering = {{"frames", double(stats.frames)},         {"files", double(stats.files)},
                         {"waits", double(stats.waits)},           {"wait_seconds", stats.wait_seconds},
                         {"drops", double(stats.drops)},           {"busy_seconds", stats.busy_seconds},
                         {"render_seconds", stats.render_seconds}, {"file_seconds", stats.file_seconds}};
    write_run_summary(paths_.summary(), summary);
}

void RunOutputs::make_movies() {
    for (const std::string& view : viz::views_with_frames(paths_.frames())) {
        try {
            viz::encode_movie(paths_.frames(), view, paths_.movie(view),
                              movie_rate(count_pictures(paths_, view)));
        } catch (const viz::VizError& error) {
            terminal_.warn(fmt::format("no movie of {}: {}", view, error.what()));
        }
    }
}

double RunOutputs::seconds_to_stop(const Run& run) const {
    constexpr double slow_disk = 1e8;             // B/s, for what was not written yet
    constexpr double bytes_a_solid_point = 200.0; // in both of its files
    const double checkpoint =
        longest_checkpoint_ > 0.0 ? longest_checkpoint_ : checkpoint_bytes(run.simulation) / slow_disk;
    const double points = run.solidification ? double(run.solidification->points.size()) : 0.0;
    return checkpoint + points * bytes_a_solid_point / slow_disk + pipeline_->seconds_to_finish();
}

void RunOutputs::finish(const Run& run, const std::string& outcome, const std::string& message,
                        Movies movies) {
    pipeline_->finish();
    const viz::PipelineStats stats = pipeline_->stats();
    terminal_.note(fmt::format(
        "pictures {}, files {}; the solver waited {} times for them, {:.2f} s; pictures given up {}",
        stats.frames, stats.files, stats.waits, stats.wait_seconds, stats.drops));
    if (draws_ && std::filesystem::is_directory(paths_.frames())) {
        if (movies == Movies::make)
            make_movies();
        else
            terminal_.say(fmt::format("no movies for want of time: `meltscope movie {}` makes them",
                                      paths_.root.string()));
    }
    if (run.solidification) {
        write_solidification_table(paths_.solidification_table(), run.solidification->points);
        viz::write_solidification_points(paths_.solidification_points(), run.solidification->points);
    }
    write_summary(run, outcome, message);
}

std::vector<std::string> RunOutputs::list() const {
    std::vector<std::string> lines;
    const auto add = [&](std::string_view what, const std::filesystem::path& path) {
        if (std::filesystem::exists(path))
            lines.push_back(fmt::format("  {:<16} {}", what, path.string()));
    };
    for (const std::string& view : viz::view_names())
        add("movie", paths_.movie(view));
    add("pictures", paths_.frames());
    for (const char* series : {"particles", "surface", "pool", "grid"})
        add("for ParaView", paths_.collection(series));
    add("melt-pool table", paths_.melt_pool_table());
    add("separate pools", paths_.separate_pools_table());
    add("solidification", paths_.solidification_table());
    add("solidification", paths_.solidification_points());
    if (last_checkpoint_)
        add("checkpoint", *last_checkpoint_);
    add("log", paths_.log());
    return lines;
}

} // namespace meltscope
