#include "meltscope/console/commands.hpp"
#include "meltscope/scenario/scenario.hpp"

#include <fmt/format.h>

#include <cmath>

/// Commands that look at the state, and pictures of it.
namespace meltscope {

std::string do_snapshot(Call& call) {
    Run& run = call.run;
    if (call.arguments.empty()) {
        run.wanted.output = run.wanted.picture = true;
        if (run.hand_out_wanted)
            run.hand_out_wanted();
        return fmt::format("output and pictures of step {}, t = {}", run.simulation.step,
                           shown(run.simulation.time, "s"));
    }
    const std::filesystem::path file = call.arguments.word("the file");
    const std::string view = call.arguments.empty() ? call.console.render.views.front()
                                                    : call.arguments.choice("the view", view_names());
    call.arguments.done();
    if (file.extension() != ".png")
        throw CommandError(fmt::format("a picture is a .png file, not {}", file.string()));
    if (!call.console.host.write_picture)
        throw CommandError("this run draws no pictures");
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
    if (std::isnan(found.temperature))
        return fmt::format("no material near there; the surface is {} away", distance);
    return fmt::format("T = {:.6g} K, {} {} the surface (step {}, t = {})", found.temperature, distance,
                       found.phi <= 0.0 ? "below" : "above", call.run.simulation.step,
                       shown(call.run.simulation.time, "s"));
}

std::string do_pool(Call& call) {
    call.arguments.done();
    const Snapshot snapshot = take_snapshot(call.run.simulation, ParticleSelection::none);
    std::string text;
    for (const PoolFigures& pool : snapshot.pools) {
        text += fmt::format("{}above {:.6g} K: ", text.empty() ? "" : "\n", pool.isotherm);
        text += pool.volume > 0.0
                    ? fmt::format("length {}, width {}, depth {}, volume {:.4g} m^3", shown(pool.length, "m"),
                                  shown(pool.width, "m"), shown(pool.depth, "m"), pool.volume)
                    : std::string("nothing");
    }
    return fmt::format("{}\npeak {:.6g} K (step {}, t = {})", text, snapshot.peak_temperature, snapshot.step,
                       shown(snapshot.time, "s"));
}

std::string do_energy(Call& call) {
    call.arguments.done();
    balance(call.run.simulation);
    const Ledger& ledger = call.run.simulation.ledger;
    std::string text;
    const auto line = [&](const char* name, double energy) {
        if (energy != 0.0)
            text += fmt::format("{:<28} {:>13.6g} J\n", name, energy);
    };
    line("emitted by the lasers", ledger.emitted);
    line("missed the material", ledger.missed);
    line("reflected", ledger.reflected);
    line("absorbed", ledger.absorbed);
    line("flowed in through faces", ledger.face_flux_in);
    line("added with particles", ledger.added);
    line("radiated", ledger.radiated);
    line("convected", ledger.convected);
    line("evaporated", ledger.evaporated);
    line("conducted out", ledger.conducted_out);
    line("change of what is stored", ledger.stored - ledger.stored_at_start);
    return text + fmt::format("{:<28} {:>13.1e}", "relative residual", ledger.relative_residual());
}

} // namespace meltscope
