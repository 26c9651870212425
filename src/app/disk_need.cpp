#include "disk_need.hpp"

#include "run_outputs.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

/// Instants of a cadence from now to the end, both counted.
double instants(const Cadence& cadence, double span, double dt) {
    if (cadence.every)
        return std::floor(span / *cadence.every + 1e-9) + 1.0;
    return cadence.every_steps ? std::floor(span / dt / double(*cadence.every_steps)) + 1.0 : 0.0;
}

} // namespace

double checkpoint_bytes(const Simulation& simulation) {
    constexpr double bytes_a_particle = 61.0, bytes_a_node = 32.0;
    return bytes_a_particle * double(simulation.particles.count()) +
           bytes_a_node * double(simulation.grid.size);
}

DiskNeed disk_need(const PreparedRun& prepared, bool draws) {
    constexpr double bytes_a_pixel = 0.15; // of a PNG picture of a scene with powder; of smooth ones half
    const Run& run = prepared.run;
    const Simulation& simulation = run.simulation;
    const double span =
        std::max(0.0, std::min(simulation.parameters.time.end, run.until.value_or(never)) - simulation.time);
    StepLimit limit;
    const double dt = largest_step(simulation, limit);
    const RenderSpec& render = prepared.scenario.render;
    const Snapshot now = take_snapshot(simulation, run.schedule.particles);

    DiskNeed need;
    need.outputs = std::int64_t(instants(run.schedule.output, span, dt));
    need.files = double(need.outputs) *
                 double(viz::estimate_file_bytes(now, file_options({}, prepared.scenario.output)));
    if (draws)
        need.pictures = instants(run.schedule.picture.value_or(run.schedule.output), span, dt) *
                        double(render.views.size()) * bytes_a_pixel * render.size[0] * render.size[1];
    const double made = instants(run.schedule.checkpoint, span, dt);
    need.checkpoints =
        std::min(made, double(prepared.scenario.checkpoint.keep) + 1.0) * checkpoint_bytes(simulation);
    return need;
}

double free_disk(const std::filesystem::path& folder) {
    std::filesystem::path there = std::filesystem::absolute(folder);
    std::error_code error;
    while (there.has_parent_path() && there != there.parent_path() && !std::filesystem::exists(there, error))
        there = there.parent_path();
    const auto space = std::filesystem::space(there, error);
    return error ? -1.0 : double(space.available);
}

std::string in_words(const DiskNeed& need) {
    return fmt::format("about {} on the disk for {} outputs: data files {}, pictures {}, checkpoints {}",
                       in_si(need.sum(), "B"), need.outputs, in_si(need.files, "B"),
                       in_si(need.pictures, "B"), in_si(need.checkpoints, "B"));
}

} // namespace meltscope
