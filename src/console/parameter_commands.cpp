#include "meltscope/console/commands.hpp"
#include "meltscope/console/parameters.hpp"
#include "meltscope/io/steering.hpp"

#include <fmt/format.h>

/// Commands that show and change parameters.
namespace meltscope {
namespace {

std::string set_parameter(Call& call, const Parameter& parameter) {
    if (!parameter.set)
        throw CommandError(
            fmt::format("{} cannot be changed in a run; the scenario sets it", parameter.name));
    if (call.arguments.empty())
        throw CommandError(fmt::format("{} needs a value: {}; it is {}", parameter.name, parameter.values,
                                       parameter.get(call.console, call.run)));
    Simulation& simulation = call.run.simulation;
    ConsoleState& console = call.console;
    const auto show = [&] {
        if (console.host.set_render)
            console.host.set_render(console.render);
    };
    const Steering before = steering_of(simulation.parameters, call.run.schedule);
    const RenderSettings render_before = console.render;
    const std::string old_value = parameter.get(console, call.run);
    std::string value;
    bool renewing = false, showing = false;
    try {
        value = parameter.set(console, call.run, call.arguments);
        call.arguments.done();
        if (call.rehearsal)
            return {};
        if (parameter.renew) {
            renewing = true;
            parameter.renew(simulation);
        }
        if (console.render != render_before) {
            showing = true;
            show();
        }
    } catch (...) {
        apply_steering(before, simulation.parameters, call.run.schedule);
        console.render = render_before;
        if (renewing)
            parameter.renew(simulation);
        if (showing)
            show();
        throw;
    }
    call.journal = fmt::format("set {} {}", parameter.name, value);
    return fmt::format("{}: {} -> {} (step {}, t = {})", parameter.name, old_value,
                       parameter.get(console, call.run), simulation.step, shown(simulation.time, "s"));
}

/// The laser that a short form means: the only one, or the one named first.
std::string laser_prefix(Call& call) {
    const std::vector<Laser>& lasers = call.run.simulation.parameters.lasers;
    if (lasers.empty())
        throw CommandError("the run has no laser");
    for (const Laser& laser : lasers)
        if (call.arguments.take(laser.name))
            return "laser." + laser.name + ".";
    return "laser.";
}

std::string set_of_laser(Call& call, const std::string& what) {
    const std::string name = laser_prefix(call) + what;
    return set_parameter(call, find_parameter(call.run.simulation.parameters.lasers, name));
}

std::string switch_laser(Call& call, const char* value) {
    const std::string name = laser_prefix(call) + "on";
    call.arguments.done();
    Arguments given({value});
    Call of_set{call.console, call.run, given, {}, false, call.rehearsal};
    const std::string text =
        set_parameter(of_set, find_parameter(call.run.simulation.parameters.lasers, name));
    call.journal = of_set.journal;
    return text;
}

} // namespace

std::string do_get(Call& call) {
    const Parameter parameter =
        find_parameter(call.run.simulation.parameters.lasers, call.arguments.word("the parameter"));
    call.arguments.done();
    return fmt::format("{} = {}", parameter.name, parameter.get(call.console, call.run));
}

std::string do_set(Call& call) {
    const std::string name = call.arguments.word("the parameter");
    call.arguments.take("=");
    return set_parameter(call, find_parameter(call.run.simulation.parameters.lasers, name));
}

std::string do_list(Call& call) {
    const std::string beginning = call.arguments.empty() ? std::string() : call.arguments.word("a beginning");
    call.arguments.done();
    std::string text;
    for (const Parameter& parameter : parameters_of(call.run.simulation.parameters.lasers))
        if (parameter.name.starts_with(beginning))
            text += fmt::format("{}{:<24} {}", text.empty() ? "" : "\n", parameter.name,
                                parameter.get(call.console, call.run));
    if (text.empty())
        throw CommandError(fmt::format("no parameter begins with \"{}\"; `list` shows all", beginning));
    return text;
}

std::string do_power(Call& call) {
    return set_of_laser(call, "power");
}

std::string do_speed(Call& call) {
    return set_of_laser(call, "speed");
}

std::string do_spot(Call& call) {
    return set_of_laser(call, "spot_radius");
}

std::string do_on(Call& call) {
    return switch_laser(call, "on");
}

std::string do_off(Call& call) {
    return switch_laser(call, "off");
}

std::string do_view(Call& call) {
    return set_parameter(call, find_parameter({}, "render.views"));
}

std::string do_field(Call& call) {
    return set_parameter(call, find_parameter({}, "render.field"));
}

} // namespace meltscope
