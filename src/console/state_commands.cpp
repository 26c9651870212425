#include "meltscope/console/commands.hpp"
#include "meltscope/io/run_folder.hpp"
#include "meltscope/io/run_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

/// Commands that keep, put back or add to the state of the run.
namespace meltscope {
namespace {

PowderLayer read_layer(Call& call) {
    Arguments& arguments = call.arguments;
    const std::vector<Material>& materials = call.run.simulation.parameters.materials;
    PowderLayer layer;
    layer.temperature = call.run.simulation.parameters.physics.ambient;
    if (call.console.host.layer)
        layer = *call.console.host.layer;
    std::vector<std::string> names;
    for (const Material& material : materials)
        names.push_back(material.name);
    while (!arguments.empty()) {
        const std::string key = arguments.choice("word of `layer`", layer_keywords());
        const auto length = [&] { return arguments.quantity(key, quantity::length, layer_keywords()); };
        if (key == "material") {
            const std::string name = arguments.choice("material", names);
            layer.material = std::int16_t(std::find(names.begin(), names.end(), name) - names.begin());
        } else if (key == "temperature") {
            layer.temperature = arguments.quantity(key, quantity::temperature, layer_keywords());
        } else if (key == "packing") {
            layer.packing = arguments.quantity(key, quantity::number, layer_keywords());
        } else if (key == "seed") {
            layer.seed = std::uint64_t(arguments.count(key));
        } else if (key == "homogenised") {
            layer.homogenised = true;
        } else if (key == "basis") {
            layer.basis = arguments.choice(key, {"number", "volume"}) == "number" ? PercentileBasis::number
                                                                                  : PercentileBasis::volume;
        } else {
            (key == "thickness" ? layer.thickness
             : key == "d10"     ? layer.d10
             : key == "d50"     ? layer.d50
                                : layer.d90) = length();
        }
    }
    require_positive(layer.thickness, "the thickness", "m");
    require_positive(layer.temperature, "the temperature", "K");
    if (!layer.homogenised && !(layer.d50 > 0.0))
        throw CommandError("the layer needs the powder's diameters, d10 D d50 D d90 D, or homogenised");
    return layer;
}

/// The layer as the journal keeps it: nothing is left to the scenario.
std::string written(const Call& call, const PowderLayer& layer) {
    const std::string& material = call.run.simulation.parameters.materials[std::size_t(layer.material)].name;
    const std::string grains =
        layer.homogenised
            ? std::string(" homogenised")
            : fmt::format(" d10 {} d50 {} d90 {} basis {} seed {}", exact(layer.d10), exact(layer.d50),
                          exact(layer.d90), layer.basis == PercentileBasis::number ? "number" : "volume",
                          layer.seed);
    return fmt::format("layer thickness {} material {} temperature {} packing {}{}", exact(layer.thickness),
                       as_word(material), exact(layer.temperature), exact(layer.packing), grains);
}

/// As take_up_journal, from the pictures' settings at the start. What waits and what pictures show stays as
/// it is if the journal cannot be taken up.
void take_up_restored_journal(ConsoleState& console, Run& run) {
    const auto waiting = console.waiting;
    const auto landings = console.landings;
    const RenderSettings render = std::exchange(console.render, console.host.render);
    const auto show = [&] {
        if (console.host.set_render)
            console.host.set_render(console.render);
    };
    try {
        take_up_journal(console, run);
        show();
    } catch (...) {
        console.waiting = waiting;
        console.landings = landings;
        console.render = render;
        show();
        throw;
    }
}

} // namespace

const std::vector<std::string>& layer_keywords() {
    static const std::vector<std::string> words{"thickness", "material",   "temperature", "d10",
                                                "d50",       "d90",        "basis",       "packing",
                                                "seed",      "homogenised"};
    return words;
}

std::string do_save(Call& call) {
    std::filesystem::path file = file_to_write(call);
    call.arguments.done();
    if (file.empty() && call.console.host.folder.empty())
        throw CommandError("there is no run folder; name a file: save FILE");
    if (call.rehearsal)
        return {};
    if (file.empty()) {
        file = RunPaths{call.console.host.folder}.checkpoint(call.run.simulation.step);
        std::filesystem::create_directories(file.parent_path());
    }
    balance(call.run.simulation);
    write_checkpoint(file, checkpoint_of(call.run, call.console.host.scenario));
    return fmt::format("{}: checkpoint of step {}, t = {}", file.string(), call.run.simulation.step,
                       shown(call.run.simulation.time, "s"));
}

std::string do_restore(Call& call) {
    const std::string file = call.arguments.word("the checkpoint");
    call.arguments.done();
    ConsoleState& console = call.console;
    if (console.from_journal)
        throw CommandError("a journal puts no checkpoint back");
    Run& run = call.run;
    const CheckpointData data = read_checkpoint(file);
    if (data.scenario != console.host.scenario)
        throw CommandError(
            fmt::format("{} was made under another scenario; `meltscope run --restart` takes it up", file));
    // The whole of it is made before anything of the run is given up.
    RunParameters parameters = console.host.parameters;
    Run back;
    back.schedule = run.schedule;
    apply_steering(read_steering(data.steering), parameters, back.schedule);
    back.simulation =
        simulation_from(data, std::move(parameters), run.simulation.grid, run.simulation.particles.lattice);
    back.layers_laid = layers_laid_by(data);
    if (run.solidification)
        back.solidification = solidification_from(data, back.simulation);
    back.journal = data.journal;
    take_up_restored_journal(console, back);
    run.simulation = std::move(back.simulation);
    run.schedule = back.schedule;
    run.journal = std::move(back.journal);
    run.layers_laid = back.layers_laid;
    run.solidification = std::move(back.solidification);
    console.goal = {console.goal.number + 1, std::nullopt, std::nullopt};
    console.running = false; // to be looked at before it goes on
    if (console.host.restored)
        console.host.restored(run);
    run.handed_out = {}; // what was written of this instant has been dropped
    run.wanted.output = run.wanted.output || due_now(run).output;
    run.wanted.picture = run.wanted.picture || due_now(run).picture;
    return fmt::format("paused, back at step {}, t = {}; the journal is that of the checkpoint",
                       run.simulation.step, shown(run.simulation.time, "s"));
}

std::string do_layer(Call& call) {
    const PowderLayer layer = read_layer(call);
    if (call.rehearsal)
        return {};
    const std::int64_t added = add_layer(call.run.simulation, layer);
    call.journal = written(call, layer);
    return fmt::format("{} particles added in a layer of {} (step {}, t = {})", added,
                       shown(layer.thickness, "m"), call.run.simulation.step,
                       shown(call.run.simulation.time, "s"));
}

} // namespace meltscope
