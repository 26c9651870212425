#include "meltscope/console/parameters.hpp"

#include "meltscope/scenario/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace meltscope {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

std::string written(double value, const Quantity& quantity) {
    return std::string_view(quantity.unit) == "1" ? exact(value)
                                                  : fmt::format("{} {}", exact(value), quantity.unit);
}

std::string shown_or(const std::optional<double>& value, const char* unit, const char* otherwise) {
    return value ? shown(*value, unit) : otherwise;
}

std::string on_off(bool on) {
    return on ? "on" : "off";
}

/// Where a cadence is kept, and what stands for none.
using CadenceOf = Cadence& (*)(Run&);

std::string shown_cadence(const Cadence& cadence) {
    if (cadence.every)
        return shown(*cadence.every, "s");
    return cadence.every_steps ? fmt::format("every {} steps", *cadence.every_steps) : "none";
}

double positive_time(Arguments& arguments, const std::string& what) {
    const double time = arguments.quantity(what, quantity::time);
    require_positive(time, what, "s");
    return time;
}

std::string set_output_every(ConsoleState&, Run& run, Arguments& arguments) {
    const double every = positive_time(arguments, "output.every");
    run.schedule.output = {every, std::nullopt};
    return written(every, quantity::time);
}

std::string set_output_every_steps(ConsoleState&, Run& run, Arguments& arguments) {
    const std::int64_t steps = arguments.count("output.every_steps");
    if (steps < 1)
        throw CommandError("output.every_steps must be 1 or more");
    run.schedule.output = {std::nullopt, steps};
    return std::to_string(steps);
}

std::string set_output_particles(ConsoleState&, Run& run, Arguments& arguments) {
    const std::string which = arguments.choice("output.particles", {"surface", "melt", "all", "none"});
    run.schedule.particles = which == "surface" ? ParticleSelection::surface
                             : which == "melt"  ? ParticleSelection::melt
                             : which == "all"   ? ParticleSelection::all
                                                : ParticleSelection::none;
    return which;
}

std::string output_particles(const ConsoleState&, const Run& run) {
    switch (run.schedule.particles) {
    case ParticleSelection::surface:
        return "surface";
    case ParticleSelection::melt:
        return "melt";
    case ParticleSelection::all:
        return "all";
    case ParticleSelection::none:
        break;
    }
    return "none";
}

std::string set_render_every(ConsoleState&, Run& run, Arguments& arguments) {
    if (arguments.take("output")) {
        run.schedule.picture.reset();
        return "output";
    }
    const double every = positive_time(arguments, "render.every");
    run.schedule.picture = Cadence{every, std::nullopt};
    return written(every, quantity::time);
}

std::string set_checkpoint_every(ConsoleState&, Run& run, Arguments& arguments) {
    if (arguments.take("none")) {
        run.schedule.checkpoint = {};
        return "none";
    }
    const double every = positive_time(arguments, "checkpoint.every");
    run.schedule.checkpoint = {every, std::nullopt};
    return written(every, quantity::time);
}

/// Puts picture settings in force; they stay as they were if the pictures refuse them.
void put(ConsoleState& console, const RenderSettings& settings) {
    if (console.host.set_render)
        console.host.set_render(settings);
    console.render = settings;
}

std::string set_views(ConsoleState& console, Run&, Arguments& arguments) {
    RenderSettings settings = console.render;
    settings.views.clear();
    do {
        const std::string view = arguments.choice("the view", view_names());
        if (std::find(settings.views.begin(), settings.views.end(), view) == settings.views.end())
            settings.views.push_back(view);
    } while (!arguments.empty());
    put(console, settings);
    return fmt::format("{}", fmt::join(settings.views, " "));
}

std::string set_field(ConsoleState& console, Run&, Arguments& arguments) {
    RenderSettings settings = console.render;
    settings.field = arguments.choice("the field", console.host.fields);
    put(console, settings);
    return settings.field;
}

std::string set_color_range(ConsoleState& console, Run&, Arguments& arguments) {
    RenderSettings settings = console.render;
    if (arguments.take("auto")) {
        settings.color_range.reset();
        put(console, settings);
        return "auto";
    }
    const double low = arguments.quantity("the cold end", quantity::temperature);
    const double high = arguments.quantity("the hot end", quantity::temperature);
    if (!(low < high))
        throw CommandError(fmt::format("the cold end must lie below the hot end, not at {} and {}",
                                       shown(low, "K"), shown(high, "K")));
    settings.color_range = {low, high};
    put(console, settings);
    return fmt::format("{} K {} K", exact(low), exact(high));
}

std::string set_colormap(ConsoleState& console, Run&, Arguments& arguments) {
    RenderSettings settings = console.render;
    settings.colormap = arguments.choice("the colour map", colormap_names());
    put(console, settings);
    return settings.colormap;
}

std::string set_background(ConsoleState& console, Run&, Arguments& arguments) {
    RenderSettings settings = console.render;
    settings.background = arguments.choice("the background", {"dark", "light"});
    put(console, settings);
    return settings.background;
}

/// Puts changed losses in force; they stay as they were if the solver refuses them.
void put(Run& run, Arguments& arguments, const PhysicsOptions& changed) {
    arguments.done();
    PhysicsOptions& physics = run.simulation.parameters.physics;
    const PhysicsOptions before = std::exchange(physics, changed);
    try {
        update_losses(run.simulation);
    } catch (...) {
        physics = before;
        update_losses(run.simulation);
        throw;
    }
}

std::string switch_loss(Run& run, Arguments& arguments, bool PhysicsOptions::*loss, const std::string& name) {
    PhysicsOptions changed = run.simulation.parameters.physics;
    changed.*loss = arguments.on_or_off(name);
    if (changed.reabsorption && !changed.radiation)
        throw CommandError("physics.reabsorption needs physics.radiation");
    put(run, arguments, changed);
    return on_off(changed.*loss);
}

std::string set_radiation(ConsoleState&, Run& run, Arguments& arguments) {
    return switch_loss(run, arguments, &PhysicsOptions::radiation, "physics.radiation");
}

std::string set_evaporation(ConsoleState&, Run& run, Arguments& arguments) {
    return switch_loss(run, arguments, &PhysicsOptions::evaporation, "physics.evaporation");
}

std::string set_reabsorption(ConsoleState&, Run& run, Arguments& arguments) {
    return switch_loss(run, arguments, &PhysicsOptions::reabsorption, "physics.reabsorption");
}

std::string set_convection(ConsoleState&, Run& run, Arguments& arguments) {
    PhysicsOptions changed = run.simulation.parameters.physics;
    changed.convection = arguments.quantity("physics.convection", quantity::heat_transfer_coefficient);
    require_between(changed.convection, 0.0, infinite, "physics.convection", "W/m^2/K");
    put(run, arguments, changed);
    return written(changed.convection, quantity::heat_transfer_coefficient);
}

std::string set_ambient(ConsoleState&, Run& run, Arguments& arguments) {
    PhysicsOptions changed = run.simulation.parameters.physics;
    changed.ambient = arguments.quantity("physics.ambient", quantity::temperature);
    require_positive(changed.ambient, "physics.ambient", "K");
    put(run, arguments, changed);
    return written(changed.ambient, quantity::temperature);
}

std::string set_blend_time(ConsoleState&, Run& run, Arguments& arguments) {
    PhysicsOptions& physics = run.simulation.parameters.physics;
    if (arguments.take("default")) {
        physics.blend_time.reset();
        return "default";
    }
    physics.blend_time = positive_time(arguments, "physics.blend_time");
    return written(*physics.blend_time, quantity::time);
}

std::string set_diffusion(ConsoleState&, Run& run, Arguments& arguments) {
    RunParameters& parameters = run.simulation.parameters;
    const std::string form = arguments.choice("physics.diffusion", {"temperature", "energy"});
    if (form == "energy" && parameters.materials.size() > 1)
        throw CommandError("the energy form of the diffusion holds for one material only");
    parameters.physics.diffuse_energy = form == "energy";
    return form;
}

std::string set_cfl(ConsoleState&, Run& run, Arguments& arguments) {
    const double cfl = arguments.quantity("time.cfl", quantity::number);
    require_positive(cfl, "time.cfl", "1");
    require_between(cfl, 0.0, 1.0, "time.cfl", "1");
    run.simulation.parameters.time.cfl = cfl;
    return exact(cfl);
}

std::string set_end(ConsoleState&, Run& run, Arguments& arguments) {
    const double end = arguments.quantity("time.end", quantity::time);
    if (!(end > run.simulation.time && std::isfinite(end)))
        throw CommandError(fmt::format("time.end must lie after now, {}, not at {}",
                                       shown(run.simulation.time, "s"), shown(end, "s")));
    run.simulation.parameters.time.end = end;
    return written(end, quantity::time);
}

std::string set_max_step(ConsoleState&, Run& run, Arguments& arguments) {
    TimeOptions& time = run.simulation.parameters.time;
    if (arguments.take("none")) {
        time.max_step.reset();
        return "none";
    }
    time.max_step = positive_time(arguments, "time.max_step");
    return written(*time.max_step, quantity::time);
}

std::string shown_face(const FaceCondition& face) {
    switch (face.kind) {
    case FaceCondition::Kind::adiabatic:
        return "adiabatic";
    case FaceCondition::Kind::fixed_temperature:
        return fmt::format("temperature {}", shown(face.temperature, "K"));
    case FaceCondition::Kind::convection:
        return fmt::format("convection {} ambient {}", shown(face.coefficient, "W/m^2/K"),
                           shown(face.temperature, "K"));
    case FaceCondition::Kind::fixed_flux:
        break;
    }
    return fmt::format("flux {}", shown(face.flux, "W/m^2"));
}

std::string set_face(Run& run, int f, Arguments& arguments) {
    FaceCondition face;
    std::string text;
    const std::string kind =
        arguments.choice("the condition", {"adiabatic", "temperature", "convection", "flux"});
    if (kind == "temperature") {
        face.kind = FaceCondition::Kind::fixed_temperature;
        face.temperature = arguments.quantity("the temperature", quantity::temperature);
        require_positive(face.temperature, "the temperature", "K");
        text = fmt::format(" {} K", exact(face.temperature));
    } else if (kind == "convection") {
        face.kind = FaceCondition::Kind::convection;
        face.coefficient = arguments.quantity("the heat transfer coefficient",
                                              quantity::heat_transfer_coefficient, {"ambient"});
        require_between(face.coefficient, 0.0, infinite, "the heat transfer coefficient", "W/m^2/K");
        face.temperature = run.simulation.parameters.physics.ambient;
        if (arguments.take("ambient"))
            face.temperature = arguments.quantity("the ambient temperature", quantity::temperature);
        require_positive(face.temperature, "the ambient temperature", "K");
        text = fmt::format(" {} W/m^2/K ambient {} K", exact(face.coefficient), exact(face.temperature));
    } else if (kind == "flux") {
        face.kind = FaceCondition::Kind::fixed_flux;
        face.flux = arguments.quantity("the flux", quantity::heat_flux);
        text = fmt::format(" {} W/m^2", exact(face.flux));
    }
    arguments.done();
    run.simulation.parameters.boundary[std::size_t(f)] = face;
    update_boundary(run.simulation);
    return kind + text;
}

Parameter face_parameter(int f) {
    return {fmt::format("boundary.{}", face_names[std::size_t(f)]),
            "adiabatic, temperature T, convection H [ambient T] or flux Q",
            "What holds at this face of the domain.",
            {"adiabatic", "temperature", "convection", "flux"},
            [f](const ConsoleState&, const Run& run) {
                return shown_face(run.simulation.parameters.boundary[std::size_t(f)]);
            },
            [f](ConsoleState&, Run& run, Arguments& arguments) { return set_face(run, f, arguments); }};
}

const PhysicsOptions& physics(const Run& run) {
    return run.simulation.parameters.physics;
}

const TimeOptions& time_options(const Run& run) {
    return run.simulation.parameters.time;
}

} // namespace

std::vector<Parameter> parameters_of(const std::vector<Laser>& lasers) {
    using Console = const ConsoleState&;
    std::vector<Parameter> all = laser_parameters(lasers);
    const std::vector<Parameter> further{
        {"output.every",
         "s, above 0",
         "Simulated time between outputs.",
         {},
         [](Console, const Run& run) { return shown_cadence(run.schedule.output); },
         set_output_every},
        {"output.every_steps",
         "1 or more",
         "Steps between outputs, instead of a time.",
         {},
         [](Console, const Run& run) { return shown_cadence(run.schedule.output); },
         set_output_every_steps},
        {"output.particles",
         "surface, melt, all or none",
         "The particles that outputs hold.",
         {"surface", "melt", "all", "none"},
         output_particles,
         set_output_particles},
        {"render.every",
         "s, above 0, or output",
         "Simulated time between pictures; output: one with each output.",
         {"output"},
         [](Console, const Run& run) {
             return run.schedule.picture ? shown_cadence(*run.schedule.picture) : "output";
         },
         set_render_every},
        {"render.views", "one or more views", "The views that are drawn.", view_names(),
         [](Console c, const Run&) { return fmt::format("{}", fmt::join(c.render.views, " ")); }, set_views},
        {"render.field",
         "a field",
         "What the colours show.",
         {},
         [](Console c, const Run&) { return c.render.field; },
         set_field},
        {"render.color_range",
         "two temperatures, or auto",
         "Cold and hot end of the colour bar.",
         {"auto"},
         [](Console c, const Run&) {
             const auto& range = c.render.color_range;
             return range ? fmt::format("{} {}", shown((*range)[0], "K"), shown((*range)[1], "K")) : "auto";
         },
         set_color_range},
        {"render.colormap", "a colour map", "The colours.", colormap_names(),
         [](Console c, const Run&) { return c.render.colormap; }, set_colormap},
        {"render.background",
         "dark or light",
         "What the pictures are drawn on.",
         {"dark", "light"},
         [](Console c, const Run&) { return c.render.background; },
         set_background},
        {"checkpoint.every",
         "s, above 0, or none",
         "Simulated time between checkpoints.",
         {"none"},
         [](Console, const Run& run) { return shown_cadence(run.schedule.checkpoint); },
         set_checkpoint_every},
        {"physics.radiation",
         "on or off",
         "Radiation of the free surface.",
         {"on", "off"},
         [](Console, const Run& run) { return on_off(physics(run).radiation); },
         set_radiation},
        {"physics.evaporation",
         "on or off",
         "Heat lost to evaporation.",
         {"on", "off"},
         [](Console, const Run& run) { return on_off(physics(run).evaporation); },
         set_evaporation},
        {"physics.reabsorption",
         "on or off",
         "Radiation between surfaces that see each other.",
         {"on", "off"},
         [](Console, const Run& run) { return on_off(physics(run).reabsorption); },
         set_reabsorption},
        {"physics.convection",
         "W/m^2/K, 0 or more",
         "Heat transfer from the free surface to the surroundings.",
         {},
         [](Console, const Run& run) { return shown(physics(run).convection, "W/m^2/K"); },
         set_convection},
        {"physics.ambient",
         "K, above 0",
         "Temperature of the surroundings.",
         {},
         [](Console, const Run& run) { return shown(physics(run).ambient, "K"); },
         set_ambient},
        {"physics.blend_time",
         "s, above 0, or default",
         "Time in which particles take on the nodes' energy.",
         {"default"},
         [](Console, const Run& run) { return shown_or(physics(run).blend_time, "s", "default"); },
         set_blend_time},
        {"physics.diffusion",
         "temperature or energy",
         "What the heat flows along the gradient of.",
         {"temperature", "energy"},
         [](Console, const Run& run) {
             return std::string(physics(run).diffuse_energy ? "energy" : "temperature");
         },
         set_diffusion},
        {"physics.transfer",
         "read only",
         "affine or flip; chosen by the scenario.",
         {},
         [](Console, const Run& run) {
             return std::string(physics(run).affine_transfer ? "affine" : "flip");
         },
         {}},
        {"physics.deposit",
         "read only",
         "surface or band; chosen by the scenario.",
         {},
         [](Console, const Run& run) {
             return std::string(physics(run).deposit_at_surface ? "surface" : "band");
         },
         {}},
        {"time.cfl",
         "above 0, up to 1",
         "Share of the largest stable step.",
         {},
         [](Console, const Run& run) { return shown(time_options(run).cfl, "1"); },
         set_cfl},
        {"time.max_step",
         "s, above 0, or none",
         "Longest step.",
         {"none"},
         [](Console, const Run& run) { return shown_or(time_options(run).max_step, "s", "none"); },
         set_max_step},
        {"time.end",
         "s, after now",
         "When the run ends.",
         {},
         [](Console, const Run& run) { return shown(time_options(run).end, "s"); },
         set_end}};
    all.insert(all.end(), further.begin(), further.end());
    for (int f = 0; f < 6; ++f)
        all.push_back(face_parameter(f));
    return all;
}

} // namespace meltscope
