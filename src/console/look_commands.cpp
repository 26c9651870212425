#include "meltscope/console/commands.hpp"
#include "meltscope/scenario/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

/// Commands that look at the state, and pictures of it.
namespace meltscope {

std::string do_snapshot(Call& call) {
    Run& run = call.run;
    if (call.arguments.empty()) {
        if (call.rehearsal)
            return {};
        run.wanted.output = run.wanted.picture = true;
        if (run.hand_out_wanted)
            run.hand_out_wanted();
        return fmt::format("output and pictures of step {}, t = {}", run.simulation.step,
                           shown(run.simulation.time, "s"));
    }
    const std::filesystem::path file = file_to_write(call);
    const std::string view = call.arguments.empty() ? call.console.render.views.front()
                                                    : call.arguments.choice("the view", view_names());
    call.arguments.done();
    if (file.extension() != ".png")
        throw CommandError(fmt::format("a picture is a .png file, not {}", file.string()));
    if (!call.console.host.write_picture)
        throw CommandError("this run draws no pictures");
    if (call.rehearsal)
        return {};
    call.console.host.write_picture(run, view, file);
    return fmt::format("{}: {} at step {}", file.string(), view, run.simulation.step);
}

std::string do_probe(Call& call) {
    Vec3 at;
    for (const int axis : {0, 1, 2})
        at[axis] = call.arguments.quantity(std::string(1, "xyz"[axis]), quantity::length);
    call.arguments.done();
    const Grid& grid = call.run.simulation.grid;
    const Vec3 low = grid.origin, high = grid.upper_corner();
    for (const int axis : {0, 1, 2})
        require_between(at[axis], low[axis], high[axis], std::string(1, "xyz"[axis]), "m");
    const Probe found = probe(call.run.simulation, at);
    const std::string distance = shown(std::abs(found.phi), "m");
    const std::string place =
        std::abs(found.phi) < 1e-3 * grid.dx
            ? "at the surface"
            : fmt::format("{} {} the surface", distance, found.phi < 0.0 ? "below" : "above");
    if (std::isnan(found.temperature))
        return fmt::format("no material near there; the surface is {} away", distance);
    return fmt::format("T = {:.6g} K, {} (step {}, t = {})", found.temperature, place,
                       call.run.simulation.step, shown(call.run.simulation.time, "s"));
}

namespace {

std::string size_of(const PoolFigures& pool) {
    return fmt::format("length {}, width {}, depth {}, volume {:.4g} m^3", shown(pool.length, "m"),
                       shown(pool.width, "m"), shown(pool.depth, "m"), pool.volume);
}

/// The pools of one isotherm: one alone without ceremony, several each with its lasers.
std::string pools_above(const Snapshot& snapshot, double isotherm) {
    std::vector<SeparatePool> pools;
    std::copy_if(snapshot.separate_pools.begin(), snapshot.separate_pools.end(), std::back_inserter(pools),
                 [&](const SeparatePool& pool) { return pool.figures.isotherm == isotherm; });
    if (pools.empty())
        return "nothing";
    if (pools.size() == 1)
        return size_of(pools.front().figures);
    std::string text = fmt::format("{} pools", pools.size());
    for (const SeparatePool& pool : pools) {
        std::vector<std::string> lasers;
        for (const int beam : pool.beams)
            lasers.push_back(snapshot.beams[beam].name);
        text += fmt::format("\n  {}{}", size_of(pool.figures),
                            lasers.empty() ? "" : fmt::format(", under {}", fmt::join(lasers, " and ")));
    }
    return text;
}

} // namespace

std::string do_pool(Call& call) {
    call.arguments.done();
    if (call.rehearsal)
        return {};
    const Snapshot snapshot = take_snapshot(call.run.simulation, ParticleSelection::none);
    std::string text;
    for (const PoolFigures& pool : snapshot.pools)
        text += fmt::format("above {:.6g} K: {}\n", pool.isotherm, pools_above(snapshot, pool.isotherm));
    return fmt::format("{}peak {:.6g} K (step {}, t = {})", text, snapshot.peak_temperature, snapshot.step,
                       shown(snapshot.time, "s"));
}

std::string do_energy(Call& call) {
    call.arguments.done();
    if (call.rehearsal)
        return {};
    balance(call.run.simulation);
    const Ledger& ledger = call.run.simulation.ledger;
    std::string text;
    for (const auto& [words, energy] : in_words(ledger))
        text += fmt::format("{:<28} {:>13.6g} J\n", words, energy);
    return text + fmt::format("{:<28} {:>13.1e}", "relative residual", ledger.relative_residual());
}

} // namespace meltscope
