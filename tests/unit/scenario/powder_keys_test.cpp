#include "example.hpp"

#include "meltscope/scenario/setup.hpp"

#include <algorithm>

namespace meltscope {
namespace {

using test::complaint;
using test::example;
using test::with;

/// The example with a powder conductivity for its steel.
std::string powdery(const std::string& body_keys) {
    const std::string text = with("liquid = [30]}", "liquid = [30], powder = [0.5]}");
    return with("max = [\"400 um\", \"200 um\", 0]\n", "max = [\"400 um\", \"200 um\", 0]\n" + body_keys,
                text);
}

std::string with_layer(const std::string& keys) {
    return with("[physics]", "[[layer]]\n" + keys + "\n[physics]", powdery(""));
}

TEST(PowderKeys, homogenised_powder_has_the_mass_of_its_packing) {
    const Scenario scenario = read_scenario_text(powdery("state = \"powder\"\npacking = 0.4\n"));
    EXPECT_EQ(scenario.bodies[0].powder_packing, 0.4);
    const ParticleList list = fill_scenario(scenario);
    ASSERT_EQ(list.powder.size(), list.position.size());
    EXPECT_TRUE(std::all_of(list.powder.begin(), list.powder.end(), [](char c) { return c == 1; }));
    EXPECT_NEAR(list.mass[0], 0.4 * 8000.0 * list.volume[0], 1e-12 * list.mass[0]);
}

TEST(PowderKeys, bulk_is_the_default_and_holds_no_powder_marks) {
    const Scenario scenario = read_scenario_text(powdery("state = \"bulk\"\n"));
    EXPECT_FALSE(scenario.bodies[0].powder_packing);
    EXPECT_TRUE(fill_scenario(scenario).powder.empty());
}

TEST(PowderKeys, what_powder_lacks_is_named) {
    const std::string dense = with("max = [\"400 um\", \"200 um\", 0]\n",
                                   "max = [\"400 um\", \"200 um\", 0]\nstate = \"powder\"\n");
    EXPECT_NE(complaint(dense).find("conductivity.powder of material \"steel\""), std::string::npos)
        << complaint(dense);
    EXPECT_NE(complaint(powdery("packing = 0.5\n")).find("state = \"powder\""), std::string::npos);
    EXPECT_NE(complaint(powdery("state = \"powder\"\npacking = 1\n")).find("below 1"), std::string::npos);
    EXPECT_NE(complaint(powdery("state = \"powder\"\npacking = -0.5\n")).find("packing"), std::string::npos);
    EXPECT_NE(complaint(powdery("state = \"powdr\"\n")).find("powder"), std::string::npos);
    EXPECT_NE(complaint(powdery("state = \"powder\"\ntemperature = 1800\n")).find("liquidus"),
              std::string::npos);
}

TEST(PowderKeys, a_layer_comes_when_the_paths_end_unless_it_has_a_time) {
    const std::string keys =
        "thickness = \"40 um\"\nmaterial = \"steel\"\nstate = \"powder\"\npacking = 0.5\n";
    const Scenario scenario = read_scenario_text(with_layer(keys));
    ASSERT_EQ(scenario.layers.size(), 1u);
    EXPECT_DOUBLE_EQ(scenario.layers[0].time, 200e-6 / 0.5);
    EXPECT_TRUE(scenario.layers[0].layer.homogenised);
    const Scenario timed = read_scenario_text(with_layer("time = \"0.2 ms\"\n" + keys));
    EXPECT_DOUBLE_EQ(timed.layers[0].time, 0.2e-3);
}

TEST(PowderKeys, layers_and_powder_survive_writing_and_reading) {
    const std::string layers =
        "thickness = \"40 um\"\nmaterial = \"steel\"\nd10 = \"11 um\"\nd50 = \"20 um\"\n"
        "d90 = \"31 um\"\npacking = 0.43\nseed = 7\ntemperature = 400\n"
        "percentiles = \"volume\"\n[[layer]]\ntime = 1e-4\n"
        "thickness = \"10 um\"\nmaterial = \"steel\"\nstate = \"powder\"\npacking = 0.6\n";
    std::string text = with("[physics]", "[[layer]]\n" + layers + "\n[physics]",
                            powdery("state = \"powder\"\npacking = 0.37\n"));
    text = with("[output]\n", "[output]\nsolidification = true\n", text);
    const Scenario once = read_scenario_text(text);
    const Scenario again = read_scenario_text(to_toml(once));
    EXPECT_EQ(once.layers, again.layers);
    ASSERT_EQ(again.layers.size(), 2u);
    EXPECT_EQ(again.bodies[0].powder_packing, 0.37);
    EXPECT_TRUE(again.output.solidification);
    EXPECT_EQ(to_toml(once), to_toml(again));
}

TEST(PowderKeys, layers_that_cannot_be_are_refused) {
    const std::string keys = "material = \"steel\"\nstate = \"powder\"\n";
    EXPECT_NE(complaint(with_layer(keys)).find("layer[0].thickness"), std::string::npos);
    EXPECT_NE(complaint(with_layer(keys + "thickness = 0\n")).find("thickness"), std::string::npos);
    EXPECT_NE(complaint(with_layer(keys + "thickness = 1e-5\ntime = 2\n")).find("before time.end"),
              std::string::npos);
    EXPECT_NE(complaint(with_layer(keys + "thickness = 1e-5\nd50 = 1e-5\n")).find("d50"), std::string::npos);
    EXPECT_NE(complaint(with_layer("material = \"steel\"\nthickness = 1e-5\n")).find("d10"),
              std::string::npos);
    EXPECT_NE(complaint(with_layer(keys + "thicknes = 1e-5\n")).find("thickness"), std::string::npos);
}

TEST(PowderKeys, a_heat_capacity_of_powder_is_said_to_have_no_effect) {
    const std::string text = with("liquid = [700]}", "liquid = [700], powder = [600]}");
    ASSERT_EQ(scenario_notes(read_scenario_text(text)).size(), 1u);
    EXPECT_NE(scenario_notes(read_scenario_text(text))[0].find("heat_capacity.powder"), std::string::npos);
    EXPECT_TRUE(scenario_notes(read_scenario_text(example)).empty());
}

TEST(ScenarioNotes, say_what_is_not_run_and_what_is_not_used) {
    const auto notes = [](const std::string& path) {
        Scenario scenario = read_scenario_text(example);
        scenario.time.end = 1e-3;
        const Vec3 middle = 0.5 * (scenario.domain.min + scenario.domain.max);
        PathSegment dwell;
        dwell.kind = PathSegment::Kind::dwell;
        dwell.end = middle;
        dwell.duration = path == "late" ? 2e-3 : 5e-4;
        scenario.lasers[0].path = ScanPath{middle, 0.0, {dwell}, {}};
        if (path == "unused") {
            scenario.materials.push_back(scenario.materials[0]);
            scenario.materials.back().name = "spare";
        }
        return scenario_notes(scenario);
    };
    EXPECT_TRUE(notes("").empty());
    for (const auto& [path, word] : {std::pair{"late", "is not run"}, {"unused", "spare"}}) {
        ASSERT_EQ(notes(path).size(), 1u) << path;
        EXPECT_NE(notes(path)[0].find(word), std::string::npos) << path;
    }
}

TEST(ScenarioNotes, say_that_cells_are_too_large_for_the_beam) {
    Scenario scenario = read_scenario_text(example);
    scenario.lasers[0].spot_radius = 5.0 * scenario.domain.cell_size; // ten cells across
    EXPECT_TRUE(scenario_notes(scenario).empty());
    scenario.lasers[0].spot_radius *= 0.5;
    ASSERT_EQ(scenario_notes(scenario).size(), 1u);
    EXPECT_NE(scenario_notes(scenario)[0].find("is 5 cells wide"), std::string::npos);
}

} // namespace
} // namespace meltscope
