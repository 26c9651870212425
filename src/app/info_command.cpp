#include "commands.hpp"
#include "exit_codes.hpp"
#include "text.hpp"

#include "meltscope/io/checkpoint.hpp"
#include "meltscope/io/run_folder.hpp"
#include "meltscope/io/run_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

namespace meltscope {
namespace {

namespace fs = std::filesystem;

void say(const std::string& line) {
    print_result(line + "\n");
}

void print_figures(const char* title, const RunSummary::Figures& figures, const char* unit) {
    say(title);
    for (const auto& [name, value] : figures)
        say(fmt::format("  {:<20} {:.6g}{}", name, value, unit));
}

void describe_checkpoint(const fs::path& file) {
    const CheckpointData data = read_checkpoint(file);
    say(fmt::format("checkpoint {} (schema {})", file.string(), data.schema_version));
    say(fmt::format("  step {}, t = {} ({:.9g} s), dt {}", data.step, in_si(data.time, "s"), data.time,
                    in_si(data.dt, "s")));
    say(fmt::format("  {} particles", data.particles.id.size()));
    std::map<std::int32_t, std::size_t> by_material;
    for (const std::int32_t material : data.particles.material)
        ++by_material[material];
    for (const auto& [material, count] : by_material)
        say(fmt::format("    of material {}: {}", material, count));
    for (const auto& array : data.grid)
        say(fmt::format("  grid array {}: {} (z y x)", array.name, fmt::join(array.dims, " x ")));
    const auto lines = std::count(data.journal.begin(), data.journal.end(), '\n');
    say(fmt::format("  scenario {} bytes, journal {} line{}", data.scenario.size(), lines,
                    lines == 1 ? "" : "s"));
    print_figures("ledger", data.ledger, " J");
}

std::size_t count_files(const fs::path& folder) {
    if (!fs::is_directory(folder))
        return 0;
    return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

void describe_run(const fs::path& folder) {
    const RunPaths paths{folder};
    const RunSummary summary = read_run_summary(paths.summary());
    say(fmt::format("run {}{}", folder.string(), summary.title.empty() ? "" : ": " + summary.title));
    say(fmt::format("  {}{}", summary.outcome, summary.message.empty() ? "" : ": " + summary.message));
    say(fmt::format("  meltscope {} ({}), {} thread{}", summary.version, summary.git_hash, summary.threads,
                    summary.threads == 1 ? "" : "s"));
    say(fmt::format("  {} particles, {} steps, t = {}", summary.particles, summary.steps,
                    in_si(summary.time, "s")));
    say(fmt::format("  {:.1f} M particle-steps/s", 1e-6 * summary.particle_steps_per_second));
    print_figures("wall seconds", summary.wall_seconds, " s");
    print_figures("ledger", summary.ledger, "");
    say("files");
    for (const char* series : {"particles", "surface", "pool", "grid"})
        if (const std::size_t count = count_files(paths.series_folder(series)); count > 0)
            say(fmt::format("  {:<20} {}", series, count));
    say(fmt::format("  {:<20} {}", "frames", count_files(paths.frames())));
    for (const CheckpointFile& checkpoint : list_checkpoints(paths))
        say(fmt::format("  checkpoint           {}", checkpoint.path.string()));
}

int describe(const fs::path& path) {
    if (!fs::exists(path))
        throw UsageError(fmt::format("there is no {}", path.string()));
    try {
        if (fs::is_directory(path))
            describe_run(path);
        else
            describe_checkpoint(path);
    } catch (const CheckpointError& error) {
        throw UsageError(error.what());
    } catch (const RunSummaryError& error) {
        throw UsageError(error.what());
    } catch (const std::system_error& error) {
        throw UsageError(error.what());
    }
    return exit_code::done;
}

} // namespace

void add_info(CLI::App& program, Action& chosen) {
    auto path = std::make_shared<fs::path>();
    CLI::App* info = program.add_subcommand("info", "Say what a checkpoint or a run folder holds");
    info->add_option("PATH", *path, "Checkpoint file or run folder")->required();
    info->footer("Examples:\n  meltscope info runs/quick_look\n"
                 "  meltscope info runs/quick_look/checkpoints/step_000000500.h5");
    info->callback([path, &chosen] { chosen = [path] { return describe(*path); }; });
}

} // namespace meltscope
