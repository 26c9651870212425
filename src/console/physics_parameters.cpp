#include "parameter_parts.hpp"

#include <fmt/format.h>

#include <cmath>

/// Parameters of the physics and of the time step.
namespace meltscope {
namespace {

std::string shown_or(const std::optional<double>& value, const char* unit, const char* otherwise) {
    return value ? shown(*value, unit) : otherwise;
}

/// Throws std::invalid_argument if a material lacks what a loss that is on needs.
void check_losses(const RunParameters& parameters) {
    const PhysicsOptions& physics = parameters.physics;
    make_loss_laws(parameters.materials,
                   {physics.radiation, physics.evaporation, physics.convection, physics.ambient});
}

std::string switch_loss(Run& run, Arguments& arguments, bool PhysicsOptions::*loss, const std::string& name) {
    PhysicsOptions& physics = run.simulation.parameters.physics;
    physics.*loss = arguments.on_or_off(name);
    if (physics.reabsorption && !physics.radiation)
        throw NotNow(
            name == "physics.radiation"
                ? "physics.reabsorption needs physics.radiation; switch physics.reabsorption off first"
                : "physics.reabsorption needs physics.radiation; switch physics.radiation on first");
    check_losses(run.simulation.parameters);
    return on_off(physics.*loss);
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
    double& convection = run.simulation.parameters.physics.convection;
    convection = arguments.quantity("physics.convection", quantity::heat_transfer_coefficient);
    require_between(convection, 0.0, infinite, "physics.convection", "W/m^2/K");
    return written(convection, quantity::heat_transfer_coefficient);
}

std::string set_ambient(ConsoleState&, Run& run, Arguments& arguments) {
    double& ambient = run.simulation.parameters.physics.ambient;
    ambient = arguments.quantity("physics.ambient", quantity::temperature);
    require_positive(ambient, "physics.ambient", "K");
    return written(ambient, quantity::temperature);
}

std::string set_quiescent_tolerance(ConsoleState&, Run& run, Arguments& arguments) {
    const double tolerance =
        arguments.quantity("physics.quiescent_tolerance", quantity::temperature_difference);
    require_between(tolerance, 0.0, highest_quiescent_tolerance, "physics.quiescent_tolerance", "K");
    run.simulation.parameters.physics.quiescent_tolerance = tolerance;
    return written(tolerance, quantity::temperature_difference);
}

std::string set_blend_time(ConsoleState&, Run& run, Arguments& arguments) {
    PhysicsOptions& physics = run.simulation.parameters.physics;
    if (!physics.affine_transfer)
        throw CommandError("physics.blend_time belongs to the affine transfer; this run has flip");
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

const PhysicsOptions& physics(const Run& run) {
    return run.simulation.parameters.physics;
}

const TimeOptions& time_options(const Run& run) {
    return run.simulation.parameters.time;
}

} // namespace

std::vector<Parameter> physics_parameters() {
    using State = const ConsoleState&;
    return {
        {"physics.radiation",
         "on or off",
         "Radiation of the free surface.",
         {"on", "off"},
         [](State, const Run& run) { return on_off(physics(run).radiation); },
         set_radiation,
         update_losses},
        {"physics.evaporation",
         "on or off",
         "Heat lost to evaporation.",
         {"on", "off"},
         [](State, const Run& run) { return on_off(physics(run).evaporation); },
         set_evaporation,
         update_losses},
        {"physics.reabsorption",
         "on or off",
         "Radiation between surfaces that see each other.",
         {"on", "off"},
         [](State, const Run& run) { return on_off(physics(run).reabsorption); },
         set_reabsorption,
         update_losses},
        {"physics.convection",
         "W/m^2/K, 0 or more",
         "Heat transfer from the free surface to the surroundings.",
         {},
         [](State, const Run& run) { return shown(physics(run).convection, "W/m^2/K"); },
         set_convection,
         update_losses},
        {"physics.ambient",
         "K, above 0",
         "Temperature of the surroundings.",
         {},
         [](State, const Run& run) { return shown(physics(run).ambient, "K"); },
         set_ambient,
         update_losses},
        {"physics.quiescent_tolerance",
         "K, 0 to 10",
         "Where all is still at its start temperature within this, no work is done.",
         {},
         [](State, const Run& run) { return shown(physics(run).quiescent_tolerance, "K"); },
         set_quiescent_tolerance},
        {"physics.blend_time",
         "s, above 0, or default",
         "Time in which particles take on the nodes' energy.",
         {"default"},
         [](State, const Run& run) { return shown_or(physics(run).blend_time, "s", "default"); },
         set_blend_time},
        {"physics.diffusion",
         "temperature or energy",
         "What the heat flows along the gradient of.",
         {"temperature", "energy"},
         [](State, const Run& run) {
             return std::string(physics(run).diffuse_energy ? "energy" : "temperature");
         },
         set_diffusion},
        {"physics.transfer",
         "read only",
         "affine or flip; chosen by the scenario.",
         {},
         [](State, const Run& run) { return std::string(physics(run).affine_transfer ? "affine" : "flip"); },
         {}},
        {"physics.deposit",
         "read only",
         "surface or band; chosen by the scenario.",
         {},
         [](State, const Run& run) {
             return std::string(physics(run).deposit_at_surface ? "surface" : "band");
         },
         {}},
        {"time.cfl",
         "above 0, up to 1",
         "Share of the largest stable step.",
         {},
         [](State, const Run& run) { return shown(time_options(run).cfl, "1"); },
         set_cfl},
        {"time.max_step",
         "s, above 0, or none",
         "Longest step.",
         {"none"},
         [](State, const Run& run) { return shown_or(time_options(run).max_step, "s", "none"); },
         set_max_step},
        {"time.end",
         "s, after now",
         "When the run ends.",
         {},
         [](State, const Run& run) { return shown(time_options(run).end, "s"); },
         set_end}};
}

} // namespace meltscope
