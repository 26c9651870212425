#include "saved_run.hpp"

#include "exit_codes.hpp"

#include "meltscope/run/cadence.hpp"
#include "meltscope/run/simulation.hpp"
#include "meltscope/scenario/scenario_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>

namespace meltscope {
namespace {

std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The row of that time; none if the table has none.
std::optional<std::size_t> row_at(const NumberTable& table, double time) {
    const std::vector<double>* times = table.find("time_s");
    for (std::size_t n = 0; times != nullptr && n < times->size(); ++n)
        if (same_instant((*times)[n], time))
            return n;
    return std::nullopt;
}

} // namespace

SavedRun::SavedRun(const RunPaths& paths) {
    if (!std::filesystem::exists(paths.scenario()))
        throw UsageError(
            fmt::format("{} holds no run (run.toml): give the folder of a run", paths.root.string()));
    scenario_ = read_scenario_text(text_of(paths.scenario()), {}, paths.scenario().string());
    table_ = parse_number_table(text_of(paths.melt_pool_table()));
}

Snapshot SavedRun::head_at(double time) const {
    Snapshot head;
    head.title = scenario_.title;
    head.time = time;
    head.solidus = scenario_.materials.front().solidus;
    head.liquidus = scenario_.materials.front().liquidus;
    const DomainSpec& domain = scenario_.domain;
    const Index3 nodes = domain.cells() + 1;
    head.nodes = {domain.min, domain.cell_size, {nodes[0], nodes[1], nodes[2]}};
    const auto row = row_at(table_, time);
    const auto cell = [&](const std::string& column, double otherwise) {
        const std::vector<double>* values = row ? table_.find(column) : nullptr;
        return values != nullptr && std::isfinite((*values)[*row]) ? (*values)[*row] : otherwise;
    };
    head.peak_temperature = cell("peak_K", 0.0);
    for (const Laser& laser : scenario_.lasers) {
        const std::string suffix = head.beams.empty() ? "" : "_" + laser.name;
        BeamSnapshot beam;
        const BeamPosition planned = beam_now(laser, time, beam.power);
        beam.name = laser.name;
        beam.position = {cell("laser_x_m" + suffix, planned.position.x()),
                         cell("laser_y_m" + suffix, planned.position.y()), planned.position.z()};
        beam.beam_direction = laser.direction;
        beam.scan_direction = planned.scan_direction;
        beam.power = cell("power_W" + suffix, beam.power);
        beam.speed = cell("speed_m_s" + suffix, planned.speed);
        beam.spot_radius = laser.spot_radius;
        beam.on = beam.power > 0.0;
        if ((beam.position - planned.position).norm() < 0.5 * domain.cell_size) {
            const PathCorners corners = corners_at(laser.path, time);
            beam.path_done = corners.done;
            beam.path_to_come = corners.to_come;
        }
        bool first = true;
        for (const double isotherm : scenario_.output.isotherms) {
            const std::string columns = (first ? "" : fmt::format("_{:.7g}K", isotherm)) + suffix;
            first = false;
            beam.pools.push_back({isotherm, cell("length_m" + columns, 0.0), cell("width_m" + columns, 0.0),
                                  cell("depth_m" + columns, 0.0), cell("volume_m3" + columns, 0.0)});
        }
        head.beams.push_back(beam);
    }
    if (!head.beams.empty())
        head.pools = head.beams.front().pools;
    return head;
}

} // namespace meltscope
