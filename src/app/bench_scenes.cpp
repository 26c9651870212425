#include "bench_scenes.hpp"

#include "meltscope/scenario/scenario_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

/// The figures of scenarios/materials/in625.toml that a step with radiation needs; and nothing sleeps.
constexpr const char* in625 = R"(
[material.in625]
density = 7569.92
solidus = 1410.0
liquidus = 1620.0
latent_heat = 2.1754e5
conductivity = {solid = [8.275, 0.01472], liquid = [4.889, 0.014743]}
heat_capacity = {solid = [579.28], liquid = [750.65]}
emissivity = 0.4
[physics]
radiation = true
quiescent_tolerance = 0.0
[time]
end = 1.0
)";

/// Lengths in m of a plate from z = `bottom` to 0, one corner at x = y = 0, with `head` above it.
struct PlateLengths {
    double cell, length, width, bottom, head;
};

/// The plate under one laser along its middle, from a quarter to three quarters of its length; last in the
/// text is the table of the laser.
std::string plate_text(const PlateLengths& plate, const std::string& on_it = {}) {
    return fmt::format(R"({in625}
[domain]
min = [0, 0, {bottom}]
max = [{length}, {width}, {head}]
cell_size = {dx}
[[body]]
shape = "box"
material = "in625"
min = [0, 0, {bottom}]
max = [{length}, {width}, 0]
{on_it}
[[laser]]
power = 180.0
absorptivity = 0.4
spot_radius = 5e-5
path = [{{move = [{start}, {across}, 0]}}, {{to = [{stop}, {across}, 0], speed = 0.8}}]
)",
                       fmt::arg("in625", in625), fmt::arg("bottom", plate.bottom),
                       fmt::arg("length", plate.length), fmt::arg("width", plate.width),
                       fmt::arg("head", plate.head), fmt::arg("dx", plate.cell), fmt::arg("on_it", on_it),
                       fmt::arg("start", 0.25 * plate.length), fmt::arg("stop", 0.75 * plate.length),
                       fmt::arg("across", 0.5 * plate.width));
}

} // namespace

Scenario bench_block(std::int64_t particles, const std::vector<std::string>& overrides) {
    const auto half = std::max<std::int64_t>(4, std::llround(std::cbrt(double(particles) / 2.0) / 2.0));
    const double dx = 1e-5, width = double(half) * dx;
    return read_scenario_text(plate_text({dx, 2.0 * width, width, -width, 3.0 * dx}), overrides, "bench");
}

Scenario bench_powder(std::int64_t particles, const std::vector<std::string>& overrides) {
    // In m; whole cells once the cell size is rounded to a part of the unit length.
    const double unit = 40e-6, length = 15.0 * unit, width = 7.5 * unit, plate = 2.0 * unit;
    const double layer = 44e-6, head = 1.5 * unit, packing = 0.45;
    const double solid = length * width * (plate + packing * layer);
    const double cells_in_unit = unit * std::cbrt(double(particles) / 8.0 / solid);
    const double dx = unit / (2.0 * std::max(1.0, std::round(0.5 * cells_in_unit)));
    const std::string balls = fmt::format(R"([[body]]
shape = "powder"
material = "in625"
min = [0, 0, 0]
max = [{length}, {width}, {layer}]
d10 = 18e-6
d50 = 26e-6
d90 = 36e-6
packing = {packing}
seed = 4
)",
                                          fmt::arg("length", length), fmt::arg("width", width),
                                          fmt::arg("layer", layer), fmt::arg("packing", packing));
    return read_scenario_text(plate_text({dx, length, width, -plate, head}, balls), overrides, "bench");
}

} // namespace meltscope
