#include "meltscope/build/fill.hpp"
#include "meltscope/console/commands.hpp"
#include "meltscope/io/run_folder.hpp"
#include "meltscope/io/run_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

/// Commands that keep, put back or add to the state of the run.
namespace meltscope {
namespace {

/// What a layer is made of and how high it reaches.
struct Layer {
    std::string material;
    PowderSpec powder;
    double temperature = 0.0; ///< K

    std::string text() const {
        const Box& box = powder.box;
        return fmt::format(
            "layer thickness {} from {} material {} temperature {} d10 {} d50 {} d90 {} packing {} "
            "seed {}",
            exact(box.max[2] - box.min[2]), exact(box.min[2]), as_word(material), exact(temperature),
            exact(powder.d10), exact(powder.d50), exact(powder.d90), exact(powder.packing), powder.seed);
    }
};

double lattice_spacing(const Simulation& s) {
    return s.grid.dx / std::max(s.particles.lattice, 1);
}

/// Height of the highest particle's upper side, m.
double top_of_material(const Simulation& s) {
    double top = s.grid.origin[2];
    for (const Vec3& at : s.particles.position)
        top = std::max(top, at[2] + 0.5 * lattice_spacing(s));
    return top;
}

Layer read_layer(Call& call) {
    Arguments& arguments = call.arguments;
    const Simulation& s = call.run.simulation;
    Layer layer;
    if (call.console.host.powder)
        layer.powder = *call.console.host.powder;
    layer.material = s.parameters.materials.front().name;
    layer.temperature = s.parameters.physics.ambient;
    double from = top_of_material(s), thickness = 0.0;
    std::vector<std::string> materials;
    for (const Material& material : s.parameters.materials)
        materials.push_back(material.name);
    while (!arguments.empty()) {
        const std::string key =
            arguments.choice("word of `layer`", {"thickness", "from", "material", "temperature", "d10", "d50",
                                                 "d90", "packing", "seed"});
        if (key == "material")
            layer.material = arguments.choice("material", materials);
        else if (key == "temperature")
            layer.temperature = arguments.quantity(key, quantity::temperature);
        else if (key == "packing")
            layer.powder.packing = arguments.quantity(key, quantity::number);
        else if (key == "seed")
            layer.powder.seed = std::uint64_t(arguments.count(key));
        else
            (key == "thickness" ? thickness
             : key == "from"    ? from
             : key == "d10"     ? layer.powder.d10
             : key == "d50"     ? layer.powder.d50
                                : layer.powder.d90) = arguments.quantity(key, quantity::length);
    }
    require_positive(thickness, "the thickness", "m");
    require_positive(layer.temperature, "the temperature", "K");
    if (!(layer.powder.d50 > 0.0))
        throw CommandError("the layer needs the powder's diameters: d10 D d50 D d90 D");
    const double ceiling = s.grid.upper_corner()[2];
    if (from + thickness > ceiling * (1.0 + 1e-12))
        throw CommandError(fmt::format("a layer from {} to {} does not fit under the domain's ceiling at {}",
                                       shown(from, "m"), shown(from + thickness, "m"), shown(ceiling, "m")));
    layer.powder.box = {s.grid.origin, s.grid.upper_corner()};
    layer.powder.box.min[2] = from;
    layer.powder.box.max[2] = from + thickness;
    return layer;
}

/// The particles of the balls, on the lattice of those that are there, outside the material that is there.
ParticleList particles_of(const Simulation& s, const Layer& layer) {
    PowderGround ground;
    ground.distance = [&s](const Vec3& point) { return probe(s, point).phi; };
    const std::vector<Shape> shapes{Balls{pack_powder(layer.powder, ground)}};
    Lattice lattice;
    lattice.spacing = lattice_spacing(s);
    lattice.origin = s.grid.origin + Vec3::Constant(0.5 * lattice.spacing);
    lattice.count = s.grid.cells * std::int64_t(std::max(s.particles.lattice, 1));
    const LatticeFill filling(shapes, lattice);

    std::int16_t material = 0;
    while (s.parameters.materials[std::size_t(material)].name != layer.material)
        ++material;
    const double energy = s.eos[std::size_t(material)].energy(layer.temperature);
    const double volume = std::pow(lattice.spacing, 3);
    std::int64_t id = s.particles.id.back();
    ParticleList list;
    std::vector<std::int16_t> sites(std::size_t(lattice.count[0] * lattice.count[1]));
    for (std::int64_t k = 0; k < lattice.count[2]; ++k) {
        filling.layer(k, sites);
        for (std::int64_t j = 0; j < lattice.count[1]; ++j)
            for (std::int64_t i = 0; i < lattice.count[0]; ++i) {
                const Vec3 at = lattice.origin + lattice.spacing * Vec3(double(i), double(j), double(k));
                if (sites[std::size_t(i + lattice.count[0] * j)] < 0 || probe(s, at).phi < 0.0)
                    continue;
                list.position.push_back(at);
                list.volume.push_back(volume);
                list.mass.push_back(volume * s.parameters.materials[std::size_t(material)].density);
                list.specific_energy.push_back(energy);
                list.id.push_back(++id);
                list.material.push_back(material);
            }
    }
    return list;
}

} // namespace

std::string do_save(Call& call) {
    std::filesystem::path file;
    if (!call.arguments.empty())
        file = call.arguments.word("the file");
    call.arguments.done();
    if (file.empty()) {
        if (call.console.host.folder.empty())
            throw CommandError("there is no run folder; name a file: save FILE");
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
    Run& run = call.run;
    const CheckpointData data = read_checkpoint(file);
    if (data.scenario != console.host.scenario)
        throw CommandError(
            fmt::format("{} was made under another scenario; `meltscope run --restart` takes it up", file));
    RunParameters parameters = console.host.parameters;
    OutputSchedule schedule = run.schedule;
    apply_steering(read_steering(data.steering), parameters, schedule);
    parse_journal(data.journal, file); // so that nothing has changed yet if it cannot be read
    run.simulation =
        simulation_from(data, std::move(parameters), run.simulation.grid, run.simulation.particles.lattice);
    run.schedule = schedule;
    run.journal = data.journal;
    console.goal = {console.goal.number + 1, std::nullopt, std::nullopt};
    console.render = console.host.render;
    if (console.host.set_render)
        console.host.set_render(console.render);
    take_up_journal(console, run);
    if (console.host.restored)
        console.host.restored(run);
    return fmt::format("back at step {}, t = {}; the journal is that of the checkpoint", run.simulation.step,
                       shown(run.simulation.time, "s"));
}

std::string do_layer(Call& call) {
    const Layer layer = read_layer(call);
    const ParticleList particles = particles_of(call.run.simulation, layer);
    if (particles.size() == 0)
        throw CommandError("the layer would hold not one particle: the powder is finer than the cells");
    add_particles(call.run.simulation, particles);
    call.journal = layer.text();
    return fmt::format("{} particles of {} added up to z = {} (step {}, t = {})", particles.size(),
                       layer.material, shown(layer.powder.box.max[2], "m"), call.run.simulation.step,
                       shown(call.run.simulation.time, "s"));
}

} // namespace meltscope
