#include "example.hpp"

#include <random>

namespace meltscope {
namespace {

using test::example;

void expect_equal(const PhaseProperty& a, const PhaseProperty& b) {
    EXPECT_EQ(a.solid.a, b.solid.a);
    EXPECT_EQ(a.liquid.a, b.liquid.a);
    ASSERT_EQ(a.powder.has_value(), b.powder.has_value());
    if (a.powder) {
        EXPECT_EQ(a.powder->a, b.powder->a);
    }
}

void expect_equal(const Material& a, const Material& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.density, b.density);
    EXPECT_EQ(a.solidus, b.solidus);
    EXPECT_EQ(a.liquidus, b.liquidus);
    EXPECT_EQ(a.latent_heat, b.latent_heat);
    expect_equal(a.conductivity, b.conductivity);
    expect_equal(a.heat_capacity, b.heat_capacity);
    EXPECT_EQ(a.emissivity, b.emissivity);
    EXPECT_EQ(a.boiling_point, b.boiling_point);
    EXPECT_EQ(a.latent_heat_of_vaporization, b.latent_heat_of_vaporization);
    EXPECT_EQ(a.molar_mass, b.molar_mass);
    EXPECT_EQ(a.source, b.source);
}

void expect_equal(const Laser& a, const Laser& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.power, b.power);
    EXPECT_EQ(a.absorptivity, b.absorptivity);
    EXPECT_EQ(a.spot_radius, b.spot_radius);
    EXPECT_EQ(a.profile, b.profile);
    EXPECT_EQ(a.super_gaussian_order, b.super_gaussian_order);
    EXPECT_EQ(a.volume_depth, b.volume_depth);
    EXPECT_EQ(a.direction, b.direction);
    EXPECT_EQ(a.on, b.on);
    EXPECT_EQ(a.path, b.path);
}

/// Shapes have no comparison of their own; their fields are compared one by one.
struct ShapesEqual {
    bool operator()(const Box& a, const Box& b) const { return a.min == b.min && a.max == b.max; }
    bool operator()(const Sphere& a, const Sphere& b) const {
        return a.center == b.center && a.radius == b.radius;
    }
    bool operator()(const Cylinder& a, const Cylinder& b) const {
        return a.base == b.base && a.axis == b.axis && a.radius == b.radius && a.height == b.height;
    }
    bool operator()(const PowderSpec& a, const PowderSpec& b) const {
        return (*this)(a.box, b.box) && a.basis == b.basis && a.d10 == b.d10 && a.d50 == b.d50 &&
               a.d90 == b.d90 && a.packing == b.packing && a.seed == b.seed;
    }
    bool operator()(const BallsSpec& a, const BallsSpec& b) const { return a.file == b.file; }
    bool operator()(const StlSpec& a, const StlSpec& b) const {
        return a.file == b.file && a.scale == b.scale;
    }
    template <class A, class B>
    bool operator()(const A&, const B&) const {
        return false;
    }
};

void expect_equal(const Scenario& a, const Scenario& b) {
    EXPECT_EQ(a.title, b.title);
    EXPECT_EQ(a.domain.min, b.domain.min);
    EXPECT_EQ(a.domain.max, b.domain.max);
    EXPECT_EQ(a.domain.cell_size, b.domain.cell_size);
    EXPECT_EQ(a.domain.particles_per_cell, b.domain.particles_per_cell);
    ASSERT_EQ(a.bodies.size(), b.bodies.size());
    for (std::size_t i = 0; i < a.bodies.size(); ++i) {
        EXPECT_TRUE(std::visit(ShapesEqual{}, a.bodies[i].shape, b.bodies[i].shape)) << "body " << i;
        EXPECT_EQ(a.bodies[i].material, b.bodies[i].material);
        EXPECT_EQ(a.bodies[i].temperature, b.bodies[i].temperature);
    }
    ASSERT_EQ(a.materials.size(), b.materials.size());
    for (std::size_t i = 0; i < a.materials.size(); ++i) {
        expect_equal(a.materials[i], b.materials[i]);
    }
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(a.boundary[i].kind, b.boundary[i].kind);
        EXPECT_EQ(a.boundary[i].temperature, b.boundary[i].temperature);
        EXPECT_EQ(a.boundary[i].convection, b.boundary[i].convection);
        EXPECT_EQ(a.boundary[i].ambient, b.boundary[i].ambient);
        EXPECT_EQ(a.boundary[i].flux, b.boundary[i].flux);
    }
    ASSERT_EQ(a.lasers.size(), b.lasers.size());
    for (std::size_t i = 0; i < a.lasers.size(); ++i) {
        expect_equal(a.lasers[i], b.lasers[i]);
    }
    EXPECT_EQ(a.physics.diffusion, b.physics.diffusion);
    EXPECT_EQ(a.physics.transfer, b.physics.transfer);
    EXPECT_EQ(a.physics.deposit, b.physics.deposit);
    EXPECT_EQ(a.physics.blend_time, b.physics.blend_time);
    EXPECT_EQ(a.physics.radiation, b.physics.radiation);
    EXPECT_EQ(a.physics.evaporation, b.physics.evaporation);
    EXPECT_EQ(a.physics.reabsorption, b.physics.reabsorption);
    EXPECT_EQ(a.physics.ambient, b.physics.ambient);
    EXPECT_EQ(a.physics.quiescent_tolerance, b.physics.quiescent_tolerance);
    EXPECT_EQ(a.level_set.radius, b.level_set.radius);
    EXPECT_EQ(a.level_set.epsilon, b.level_set.epsilon);
    EXPECT_EQ(a.time.end, b.time.end);
    EXPECT_EQ(a.time.cfl, b.time.cfl);
    EXPECT_EQ(a.time.max_step, b.time.max_step);
    EXPECT_EQ(a.output.every, b.output.every);
    EXPECT_EQ(a.output.every_steps, b.output.every_steps);
    EXPECT_EQ(a.output.particles, b.output.particles);
    EXPECT_EQ(a.output.surface, b.output.surface);
    EXPECT_EQ(a.output.pool, b.output.pool);
    EXPECT_EQ(a.output.grid, b.output.grid);
    EXPECT_EQ(a.output.compression, b.output.compression);
    EXPECT_EQ(a.output.precision, b.output.precision);
    EXPECT_EQ(a.output.isotherms, b.output.isotherms);
    EXPECT_EQ(a.render.every, b.render.every);
    EXPECT_EQ(a.render.size, b.render.size);
    EXPECT_EQ(a.render.views, b.render.views);
    EXPECT_EQ(a.render.color_range, b.render.color_range);
    EXPECT_EQ(a.render.colormap, b.render.colormap);
    EXPECT_EQ(a.render.on_backlog, b.render.on_backlog);
    EXPECT_EQ(a.render.background, b.render.background);
    EXPECT_EQ(a.checkpoint.every, b.checkpoint.every);
    EXPECT_EQ(a.checkpoint.keep, b.checkpoint.keep);
}

/// Every key away from its default, and numbers that have no short decimal.
const std::string full = R"(title = "all \"keys\" \\ \u00b5"
materials = ["materials/ss316l.toml", "materials/in625.toml"]

[domain]
min = ["0 um", "1 inch", "-100 um"]
max = ["400 um", "2 inch", "20 um"]
cell_size = "10 um"
particles_per_cell = 27

[material."a b.c"]
density = "1.1 lb/inch^3"
solidus = "1111.1 degF"
liquidus = "1700 degF"
latent_heat = "0.3 J/mg"
conductivity = {solid = [20.1, -1e-3, 1e-7], liquid = [30.3, 0.1], powder = [0.3]}
heat_capacity = {solid = [500.7], liquid = [700.3], powder = [333.33]}
emissivity = 0.37
boiling_point = 3333.3
latent_heat_of_vaporization = 7.1e6
molar_mass = "55.8 g/mol"
source = "none \"at all\" \u0007\n"

[[body]]
shape = "box"
material = "in625"
min = [0, "1 inch", "-100 um"]
max = ["133.3 um", "1.1 inch", -0.0]
[[body]]
shape = "sphere"
material = "a b.c"
temperature = 333.3
center = [1e-4, "1.3 inch", 0]
radius = "20.7 um"
[[body]]
shape = "cylinder"
material = "ss316l"
base = [1e-4, "1.4 inch", 0]
axis = [1, 2, 3]
radius = 1.1e-5
height = 1.3e-5
[[body]]
shape = "powder"
material = "in625"
min = [0, "1 inch", 0]
max = [4e-4, "1.2 inch", 2e-5]
d10 = "16.1 um"
d50 = "20.1 um"
d90 = "30.1 um"
packing = 0.51
percentiles = "volume"
seed = 9223372036854775807
[[body]]
shape = "balls"
material = "in625"
file = "materials/in625.toml"
[[body]]
shape = "stl"
material = "in625"
file = "quick_look.toml"
scale = "1 inch"

[boundary]
x_min = {temperature = "25 degC"}
x_max = {convection = 11.1}
y_min = {convection = 12.3, ambient = 310.1}
z_min = {flux = -1234.5}

[[laser]]
name = "first"
power = "0.1 hp"
absorptivity = "37.1 %"
d4sigma = "170.1 um"
direction = [0.1, 0.2, -0.9]
on = false
start_time = "1.1 us"
path = [
    {move = [1e-4, "1.1 inch", 0]}, {to = [3e-4, "1.2 inch", 1e-6], speed = 0.7, power = 33.3}, {dwell = "2.3 us"},
    {move = [3e-4, "1.3 inch", 0]}, {move = [1e-4, "1.5 inch", 0], speed = 3.3}, {dwell = 1e-6, on = false},
    {dwell = 1.7e-6, at = [2e-4, "1.6 inch", 0], power = 0}, {dwell = 0}, {move = [1e-4, "1.7 inch", 0], power = 3}]
[[laser]]
power = 50
absorptivity = 0.3
spot_radius = 3e-5
profile = "super_gaussian"
super_gaussian_order = 3.3
[laser.pattern]
type = "island"
min = [1e-4, "1.1 inch"]
max = [3e-4, "1.11 inch"]
hatch = 5e-5
angle = "33 deg"
speed = 0.9
power = 44.4
island_size = "100 um"
island_rotation = "90 deg"
seed = 3
turn_time = 1e-6
layers = 2
layer_pause = "10 us"
[[laser]]
power = 50
absorptivity = 0.3
spot_radius = 3e-5
profile = "volumetric"
volume_depth = 1.7e-5
path = [{to = [1e-4, "1.1 inch", 0]}]

[physics]
diffusion = "energy"
deposit = "band"
blend_time = "1.3 us"
ambient = 295.3
quiescent_tolerance = "1.7 mK"

[level_set]
radius = 1.1
epsilon = 0.7

[time]
end = "1.1 ms"
cfl = 0.43
max_step = 1.9e-7

[output]
every_steps = 17
particles = "melt"
surface = false
pool = false
grid = true
compression = "lz4"
precision = "float64"
isotherms = ["1290.3 degC", 1600]

[render]
every = "33.3 us"
size = [640, 482]
views = ["top", "overview"]
color_range = [300.1, 2000.3]
colormap = "viridis"
on_backlog = "drop"
background = "light"

[checkpoint]
every = "0.37 ms"
keep = 5
)";

TEST(scenario_write, the_written_scenario_reads_back_bit_for_bit) {
    const Scenario scenario = read_scenario_text(full, {}, "full.toml", MELTSCOPE_SOURCE_DIR "/scenarios");
    ASSERT_EQ(scenario.lasers.size(), 3u);
    ASSERT_EQ(scenario.materials.size(), 3u);
    const std::string text = to_toml(scenario);
    const Scenario again =
        read_scenario_text(text, {}, "run.toml", "/"); // files are absolute: the folder is of no account
    expect_equal(again, scenario);
    EXPECT_EQ(to_toml(again), text);
    EXPECT_TRUE(std::signbit(std::get<Box>(again.bodies[0].shape).max[2]));
}

TEST(scenario_write, defaults_are_written_out) {
    const Scenario scenario = read_scenario_text(example);
    const std::string text = to_toml(scenario);
    expect_equal(read_scenario_text(text), scenario);
    for (const char* line :
         {"particles_per_cell = 8\n", "temperature = 298.15\n", "cfl = 0.5\n", "transfer = \"affine\"\n",
          "isotherms = [1700.0]\n", "colormap = \"inferno\"\n", "x_max = \"adiabatic\"\n"}) {
        EXPECT_NE(text.find(line), std::string::npos) << line;
    }
}

TEST(scenario_write, any_double_survives_the_way_through_text) {
    std::mt19937_64 random(42);
    Scenario scenario = read_scenario_text(example);
    for (int i = 0; i < 50; ++i) { // each reads the unit database, which takes a few milliseconds
        const double mantissa = static_cast<double>(random() >> 11) * 0x1p-53;
        const double power = std::ldexp(1.0 + mantissa, static_cast<int>(random() % 1000) - 500);
        scenario.lasers[0].power = power;
        EXPECT_EQ(read_scenario_text(to_toml(scenario)).lasers[0].power, power);
    }
}

} // namespace
} // namespace meltscope
