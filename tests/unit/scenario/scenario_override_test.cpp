#include "example.hpp"

namespace meltscope {
namespace {

using test::complaint;
using test::example;
using test::with;

Scenario overridden(const std::vector<std::string>& overrides, const std::string& text = example) {
    return read_scenario_text(text, overrides, "track.toml");
}

const std::string second_laser = R"([[laser]]
name = "second"
power = 50
absorptivity = 0.3
spot_radius = 3e-5
path = [{move = [1e-4, 1e-4, 0]}]
)";

TEST(scenario_override, values_take_units_without_quotation_marks) {
    const Scenario scenario = overridden(
        {"laser.power=200 W", "domain.cell_size = 20 um", "time.end=2 ms", "laser[0].absorptivity=0.5",
         "render.size=[640, 480]", "checkpoint.every=\"1 ms\"", "title=my track", "physics.diffusion=energy",
         "output.surface=false", "laser.path[1].speed=1 m/s", "level_set.radius=1.5"});
    EXPECT_EQ(scenario.lasers[0].power, 200.0);
    EXPECT_EQ(scenario.domain.cell_size, 20e-6);
    EXPECT_EQ(scenario.time.end, 2e-3);
    EXPECT_EQ(scenario.lasers[0].absorptivity, 0.5);
    EXPECT_EQ(scenario.render.size, (std::array{640, 480}));
    EXPECT_EQ(scenario.checkpoint.every, 1e-3);
    EXPECT_EQ(scenario.title, "my track");
    EXPECT_EQ(scenario.physics.diffusion, PhysicsSpec::Diffusion::energy);
    EXPECT_FALSE(scenario.output.surface);
    EXPECT_EQ(scenario.lasers[0].path.segments[0].speed, 1.0);
    EXPECT_EQ(scenario.level_set.radius, 1.5);
}

TEST(scenario_override, the_last_of_two_wins) {
    EXPECT_EQ(overridden({"laser.power=200", "laser.power=300"}).lasers[0].power, 300.0);
}

TEST(scenario_override, one_of_several_lasers_is_named_by_index_or_name) {
    const std::string text = example + second_laser;
    EXPECT_EQ(overridden({"laser[1].power=60"}, text).lasers[1].power, 60.0);
    EXPECT_EQ(overridden({"laser.second.power=70 W"}, text).lasers[1].power, 70.0);
    EXPECT_EQ(complaint(text, {"laser.power=60"}),
              "--set laser.power=60: laser.power: which one? There are laser[0] to laser[1], laser.second");
    EXPECT_EQ(complaint(text, {"laser[2].power=60"}),
              "--set laser[2].power=60: laser[2]: the list has [0] to [1]");
}

TEST(scenario_override, whole_elements_and_tables_can_be_replaced) {
    EXPECT_EQ(overridden({"laser[0].path[0]={move = [2e-4, 1e-4, 0]}"}).lasers[0].path.start,
              Vec3(2e-4, 1e-4, 0.0));
    EXPECT_EQ(overridden({"boundary.z_min=adiabatic"}).boundary[4].kind, FaceSpec::Kind::adiabatic);
    EXPECT_EQ(overridden({"boundary.x_min.temperature=400 K"}).boundary[0].temperature, 400.0);
}

TEST(scenario_override, material_files_are_reached_into) {
    const std::filesystem::path track = MELTSCOPE_SOURCE_DIR "/scenarios/quick_look.toml";
    EXPECT_EQ(read_scenario(track, {"material.in625.emissivity=0.3"}).materials[0].emissivity, 0.3);
}

TEST(scenario_override, mistakes_name_the_override) {
    EXPECT_EQ(
        complaint(example, {"laser.power=200 X"}),
        "--set laser.power=200 X: laser[0].power: \"X\" is not a unit; a power is written as \"1.5 W\"");
    EXPECT_EQ(complaint(example, {"laser.powr=200 W"})
                  .find("--set laser.powr=200 W: laser[0].powr: unknown key; did you "
                        "mean \"power\"?"),
              0u);
    EXPECT_EQ(complaint(example, {"lasers.power=1"})
                  .find("--set lasers.power=1: lasers: unknown key; did you mean "
                        "\"laser\"?"),
              0u);
    EXPECT_EQ(complaint(example, {"time.end.x=1"}),
              "--set time.end.x=1: time.end.x: time.end is not a table");
    EXPECT_EQ(complaint(example, {"time[0]=1"}), "--set time[0]=1: time[0]: time is not a list");
    EXPECT_EQ(complaint(example, {"time.end"}),
              "--set time.end: expected KEY=VALUE, for example laser.power=200 W");
    EXPECT_EQ(complaint(example, {"time.end="}), "--set time.end=: the value is missing");
    EXPECT_EQ(complaint(example, {"output.isotherms=[1500 K]"}),
              "--set output.isotherms=[1500 K]: the value is not valid TOML");
}

TEST(scenario_override, malformed_keys_are_refused) {
    for (const char* key :
         {"=1", ".=1", "a..b=1", "[0]=1", "laser[=1", "laser[x].power=1", "laser[-1].power=1",
          "laser[0]power=1", "\"a=1", "laser[99999999999999999999].power=1",
          "a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q=1", "laser.=1", "time.end=\x01\n"}) {
        EXPECT_NE(complaint(example, {key}), "") << key;
    }
}

} // namespace
} // namespace meltscope
