#include "parameter_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

/// Power while the beam is on, W: what the path asks for here, or the laser's own.
double power_of(const Laser& laser, double time) {
    return beam_at(laser.path, time).power.value_or(laser.power);
}

/// Speed of the line that is run, or of the next one with light, m/s; zero if none is left.
double speed_of(const Laser& laser, double time) {
    if (const double now = beam_at(laser.path, time).speed; now > 0.0)
        return now;
    for (const PathSegment& segment : path_from(laser.path, time).segments)
        if (segment.kind == PathSegment::Kind::line && segment.laser_on)
            return segment.speed;
    return 0.0;
}

std::string set_power(Run& run, Laser& laser, Arguments& arguments) {
    const double power = arguments.quantity("the power", quantity::power);
    require_between(power, 0.0, infinite, "the power", "W");
    const double time = run.simulation.time;
    // A path that sets powers of its own would keep them.
    const bool path_has_powers = std::any_of(laser.path.segments.begin(), laser.path.segments.end(),
                                             [](const PathSegment& s) { return s.power && s.laser_on; });
    if (path_has_powers)
        laser.path = with_power_from(laser.path, time, std::nullopt);
    laser.power = power;
    return written(power, quantity::power);
}

std::string set_speed(Run& run, Laser& laser, Arguments& arguments) {
    const double speed = read_scan_speed(arguments);
    if (speed_of(laser, run.simulation.time) == 0.0)
        throw NotNow(fmt::format("the path of {} has no line left that could be run faster or slower; "
                                 "`path line X Y speed V` adds one",
                                 laser.name));
    laser.path = with_speed_from(laser.path, run.simulation.time, speed);
    return written(speed, quantity::speed);
}

std::string set_spot(Run& run, Laser& laser, Arguments& arguments) {
    const double radius = arguments.quantity("the spot radius", quantity::length);
    require_positive(radius, "the spot radius", "m");
    const Grid& grid = run.simulation.grid;
    const double largest = (grid.upper_corner() - grid.origin).maxCoeff();
    if (radius < grid.dx || radius > largest)
        throw CommandError(fmt::format(
            "the spot radius must lie between a cell, {}, and the size of the domain, {}; it is {}",
            shown(grid.dx, "m"), shown(largest, "m"), shown(radius, "m")));
    laser.spot_radius = radius;
    return written(radius, quantity::length);
}

std::string set_absorptivity(Run&, Laser& laser, Arguments& arguments) {
    const double share = arguments.quantity("the absorptivity", quantity::number);
    require_between(share, 0.0, 1.0, "the absorptivity", "1");
    laser.absorptivity = share;
    return exact(share);
}

std::string set_on(Run&, Laser& laser, Arguments& arguments) {
    laser.on = arguments.on_or_off("laser.on");
    return laser.on ? "on" : "off";
}

struct LaserParameter {
    const char* name;
    const char* values;
    const char* help;
    std::vector<std::string> words;
    std::string (*get)(const Laser&, double time);
    std::string (*set)(Run&, Laser&, Arguments&);
};

const std::vector<LaserParameter>& table() {
    static const std::vector<LaserParameter> rows{
        {"power",
         "W, 0 or more",
         "Power while the beam is on; takes the place of powers that the path sets.",
         {},
         [](const Laser& l, double t) { return shown(power_of(l, t), "W"); },
         set_power},
        {"speed",
         "m/s, above 0, up to 100",
         "Speed of all lines with light that are left of the path.",
         {},
         [](const Laser& l, double t) { return shown(speed_of(l, t), "m/s"); },
         set_speed},
        {"spot_radius",
         "m, from a cell to the domain",
         "1/e^2 radius of the beam.",
         {},
         [](const Laser& l, double) { return shown(l.spot_radius, "m"); },
         set_spot},
        {"absorptivity",
         "0 to 1",
         "Share of the light that the material absorbs.",
         {},
         [](const Laser& l, double) { return shown(l.absorptivity, "1"); },
         set_absorptivity},
        {"on",
         "on or off",
         "Off keeps the laser dark while its path goes on.",
         {"on", "off"},
         [](const Laser& l, double) { return std::string(l.on ? "on" : "off"); },
         set_on}};
    return rows;
}

} // namespace

double read_scan_speed(Arguments& arguments, const std::vector<std::string>& keywords) {
    constexpr double fastest = 100.0; // m/s, several times what scanners do
    const double speed = arguments.quantity("the speed", quantity::speed, keywords);
    require_positive(speed, "the speed", "m/s");
    if (speed > fastest)
        throw CommandError(
            fmt::format("the speed must be at most {}, not {}; is a unit missing, as in 800 mm/s?",
                        shown(fastest, "m/s"), shown(speed, "m/s")));
    return speed;
}

std::vector<Parameter> laser_parameters(const std::vector<Laser>& lasers) {
    std::vector<Parameter> parameters;
    for (std::size_t n = 0; n < lasers.size(); ++n)
        for (const LaserParameter& row : table())
            parameters.push_back({lasers.size() == 1 ? fmt::format("laser.{}", row.name)
                                                     : fmt::format("laser.{}.{}", lasers[n].name, row.name),
                                  row.values, row.help, row.words,
                                  [n, get = row.get](const ConsoleState&, const Run& run) {
                                      return get(run.simulation.parameters.lasers[n], run.simulation.time);
                                  },
                                  [n, set = row.set](ConsoleState&, Run& run, Arguments& arguments) {
                                      return set(run, run.simulation.parameters.lasers[n], arguments);
                                  }});
    return parameters;
}

Parameter find_parameter(const std::vector<Laser>& lasers, const std::string& name) {
    const std::vector<Parameter> all = parameters_of(lasers);
    std::string wanted = name;
    if (lasers.size() == 1) {
        const std::string own = "laser." + lasers[0].name + ".";
        if (wanted.starts_with(own))
            wanted = "laser." + wanted.substr(own.size());
    } else if (lasers.size() > 1) {
        for (const LaserParameter& row : table())
            if (wanted == fmt::format("laser.{}", row.name)) {
                std::vector<std::string> each;
                for (const Laser& laser : lasers)
                    each.push_back(fmt::format("laser.{}.{}", laser.name, row.name));
                throw CommandError(fmt::format("there are several lasers: say {}", fmt::join(each, " or ")));
            }
    }
    std::vector<std::string> names;
    for (const Parameter& parameter : all)
        names.push_back(parameter.name);
    const std::string found = resolve(wanted, names, "parameter");
    return *std::find_if(all.begin(), all.end(), [&](const Parameter& p) { return p.name == found; });
}

} // namespace meltscope
