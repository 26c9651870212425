#include "parameter_parts.hpp"

#include "meltscope/scenario/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>

/// Parameters of outputs, pictures and checkpoints.
namespace meltscope {
namespace {

std::string shown_cadence(const Cadence& cadence) {
    if (cadence.every)
        return shown(*cadence.every, "s");
    return cadence.every_steps ? fmt::format("every {} steps", *cadence.every_steps) : "none";
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

std::string set_views(ConsoleState& console, Run&, Arguments& arguments) {
    std::vector<std::string>& views = console.render.views;
    views.clear();
    do {
        const std::string view = arguments.choice("the view", view_names());
        if (std::find(views.begin(), views.end(), view) == views.end())
            views.push_back(view);
    } while (!arguments.empty());
    return fmt::format("{}", fmt::join(views, " "));
}

std::string set_field(ConsoleState& console, Run&, Arguments& arguments) {
    return console.render.field = arguments.choice("the field", console.host.fields);
}

std::string set_color_range(ConsoleState& console, Run&, Arguments& arguments) {
    if (arguments.take("auto")) {
        console.render.color_range.reset();
        return "auto";
    }
    const double low = arguments.quantity("the cold end", quantity::temperature);
    const double high = arguments.quantity("the hot end", quantity::temperature);
    if (!(low < high))
        throw CommandError(fmt::format("the cold end must lie below the hot end, not at {} and {}",
                                       shown(low, "K"), shown(high, "K")));
    console.render.color_range = {low, high};
    return fmt::format("{} K {} K", exact(low), exact(high));
}

std::string set_colormap(ConsoleState& console, Run&, Arguments& arguments) {
    return console.render.colormap = arguments.choice("the colour map", colormap_names());
}

std::string set_background(ConsoleState& console, Run&, Arguments& arguments) {
    return console.render.background = arguments.choice("the background", {"dark", "light"});
}

} // namespace

std::vector<Parameter> output_parameters() {
    using State = const ConsoleState&;
    return {
        {"output.every",
         "s, above 0",
         "Simulated time between outputs.",
         {},
         [](State, const Run& run) { return shown_cadence(run.schedule.output); },
         set_output_every},
        {"output.every_steps",
         "1 or more",
         "Steps between outputs, instead of a time.",
         {},
         [](State, const Run& run) { return shown_cadence(run.schedule.output); },
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
         [](State, const Run& run) {
             return run.schedule.picture ? shown_cadence(*run.schedule.picture) : "output";
         },
         set_render_every},
        {"render.views", "one or more views", "The views that are drawn.", view_names(),
         [](State c, const Run&) { return fmt::format("{}", fmt::join(c.render.views, " ")); }, set_views},
        {"render.field",
         "a field",
         "What the colours show.",
         {},
         [](State c, const Run&) { return c.render.field; },
         set_field},
        {"render.color_range",
         "two temperatures, or auto",
         "Cold and hot end of the colour bar.",
         {"auto"},
         [](State c, const Run&) {
             const auto& range = c.render.color_range;
             return range ? fmt::format("{} {}", shown((*range)[0], "K"), shown((*range)[1], "K")) : "auto";
         },
         set_color_range},
        {"render.colormap", "a colour map", "The colours.", colormap_names(),
         [](State c, const Run&) { return c.render.colormap; }, set_colormap},
        {"render.background",
         "dark or light",
         "What the pictures are drawn on.",
         {"dark", "light"},
         [](State c, const Run&) { return c.render.background; },
         set_background},
        {"checkpoint.every",
         "s, above 0, or none",
         "Simulated time between checkpoints.",
         {"none"},
         [](State, const Run& run) { return shown_cadence(run.schedule.checkpoint); },
         set_checkpoint_every}};
}

} // namespace meltscope
