#include "example.hpp"

#include <fstream>

namespace meltscope {
namespace {

using test::example;
using test::with;

TEST(scenario_read, units_become_si_and_absent_keys_their_defaults) {
    const Scenario scenario = read_scenario_text(example);
    EXPECT_EQ(scenario.title, "example");
    EXPECT_EQ(scenario.domain.min, Vec3(0.0, 0.0, -100e-6));
    EXPECT_EQ(scenario.domain.max, Vec3(400e-6, 200e-6, 20e-6));
    EXPECT_EQ(scenario.domain.particles_per_cell, 8);
    EXPECT_EQ(scenario.domain.particle_spacing(), 5e-6);
    EXPECT_TRUE((scenario.domain.cells() == Index3(40, 20, 12)).all());
    ASSERT_EQ(scenario.bodies.size(), 1u);
    EXPECT_EQ(scenario.bodies[0].material, "steel");
    EXPECT_EQ(scenario.bodies[0].temperature, 298.15);
    EXPECT_EQ(std::get<Box>(scenario.bodies[0].shape).max, Vec3(400e-6, 200e-6, 0.0));
    EXPECT_EQ(scenario.boundary[4].kind, FaceSpec::Kind::temperature);
    EXPECT_EQ(scenario.boundary[4].temperature, 300.0);
    EXPECT_EQ(scenario.boundary[5].kind, FaceSpec::Kind::adiabatic);
    EXPECT_EQ(scenario.physics.transfer, PhysicsSpec::Transfer::affine);
    EXPECT_EQ(scenario.physics.ambient, 298.15);
    EXPECT_EQ(scenario.time.end, 1e-3);
    EXPECT_EQ(scenario.time.cfl, 0.5);
    EXPECT_EQ(scenario.output.every, 50e-6);
    EXPECT_EQ(scenario.output.isotherms, std::vector<double>{1700.0});
    EXPECT_EQ(scenario.checkpoint.keep, 3);
    EXPECT_FALSE(scenario.checkpoint.every);
}

TEST(scenario_read, an_inline_path_becomes_segments) {
    const Scenario scenario = read_scenario_text(with("path = [{move = [\"100 um\", \"100 um\", 0]}, {to = "
                                                      "[\"300 um\", \"100 um\", 0], speed = \"0.5 m/s\"}]",
                                                      "path = [{move = [1e-4, 1e-4, 0]}, {to = [3e-4, 1e-4, "
                                                      "0], speed = 0.5, power = 90}, {dwell = \"2 us\"},\n"
                                                      "        {move = [3e-4, 1.5e-4, 0]}, {move = [1e-4, "
                                                      "1.5e-4, 0], speed = 3}, {dwell = 1e-6, on = false}]"));
    const ScanPath& path = scenario.lasers.at(0).path;
    EXPECT_EQ(path.start, Vec3(1e-4, 1e-4, 0.0));
    ASSERT_EQ(path.segments.size(), 5u);
    EXPECT_EQ(path.segments[0].kind, PathSegment::Kind::line);
    EXPECT_EQ(path.segments[0].end, Vec3(3e-4, 1e-4, 0.0));
    EXPECT_EQ(path.segments[0].power, 90.0);
    EXPECT_TRUE(path.segments[0].laser_on);
    EXPECT_EQ(path.segments[1].kind, PathSegment::Kind::dwell);
    EXPECT_EQ(path.segments[1].duration, 2e-6);
    EXPECT_EQ(path.segments[1].end, path.segments[0].end);
    EXPECT_FALSE(path.segments[2].laser_on); // a jump takes no time
    EXPECT_EQ(path.segments[2].duration, 0.0);
    EXPECT_EQ(path.segments[3].kind, PathSegment::Kind::line);
    EXPECT_FALSE(path.segments[3].laser_on);
    EXPECT_FALSE(path.segments[4].laser_on);
    EXPECT_DOUBLE_EQ(path_end_time(path), 2e-4 / 0.5 + 2e-6 + 2e-4 / 3.0 + 1e-6);
}

TEST(scenario_read, a_path_that_begins_with_a_line_starts_at_its_point) {
    const ScanPath path =
        read_scenario_text(with("{move = [\"100 um\", \"100 um\", 0]}", "{to = [\"100 um\", \"100 um\", 0]}"))
            .lasers[0]
            .path;
    EXPECT_EQ(path.start, Vec3(100e-6, 100e-6, 0.0));
    EXPECT_EQ(path.segments.size(), 1u);
}

TEST(scenario_read, half_of_d4sigma_is_the_spot_radius) {
    const Scenario scenario = read_scenario_text(with("spot_radius = \"50 um\"", "d4sigma = \"170 um\""));
    EXPECT_EQ(scenario.lasers[0].spot_radius, 85e-6);
}

TEST(scenario_read, directions_are_made_unit) {
    const Scenario scenario =
        read_scenario_text(with("absorptivity = 0.4", "absorptivity = 0.4\ndirection = [3e200, 0, -4e200]"));
    EXPECT_NEAR((scenario.lasers[0].direction - Vec3(0.6, 0.0, -0.8)).norm(), 0.0, 1e-15);
}

TEST(scenario_read, every_shape_of_body_is_read) {
    const std::string steel = "material = \"steel\"\n";
    const std::string folder = MELTSCOPE_SOURCE_DIR "/scenarios";
    const Scenario scenario = read_scenario_text(
        example + "[[body]]\nshape = \"sphere\"\ncenter = [1e-4, 1e-4, 0]\nradius = \"20 um\"\n" + steel +
            "[[body]]\nshape = \"cylinder\"\nbase = [1e-4, 1e-4, 0]\naxis = [0, 2, 0]\nradius = 1e-5\nheight "
            "= 1e-5\n" +
            steel +
            "[[body]]\nshape = \"powder\"\nmin = [0, 0, 0]\nmax = [4e-4, 2e-4, 2e-5]\nd10 = \"16 um\"\nd50 = "
            "\"20 "
            "um\"\nd90 = \"30 um\"\npacking = 0.55\nseed = 7\ntemperature = \"200 degC\"\n" +
            steel + "[[body]]\nshape = \"balls\"\nfile = \"quick_look.toml\"\n" + steel +
            "[[body]]\nshape = \"stl\"\nfile = \"quick_look.toml\"\nscale = \"1 mm\"\n" + steel,
        {}, "scenario", folder);
    ASSERT_EQ(scenario.bodies.size(), 6u);
    EXPECT_EQ(std::get<Sphere>(scenario.bodies[1].shape).radius, 20e-6);
    EXPECT_EQ(std::get<Cylinder>(scenario.bodies[2].shape).axis, Vec3(0.0, 1.0, 0.0));
    const auto& powder = std::get<PowderSpec>(scenario.bodies[3].shape);
    EXPECT_EQ(powder.d90, 30e-6);
    EXPECT_EQ(powder.seed, 7u);
    EXPECT_DOUBLE_EQ(scenario.bodies[3].temperature, 473.15);
    EXPECT_TRUE(std::get<BallsSpec>(scenario.bodies[4].shape).file.is_absolute());
    EXPECT_EQ(std::get<StlSpec>(scenario.bodies[5].shape).scale, 1e-3);
}

TEST(scenario_read, every_kind_of_face_is_read) {
    const Scenario scenario = read_scenario_text(with(
        "z_min = {temperature = 300}", "x_min = \"adiabatic\"\nx_max = {temperature = \"25 degC\"}\n"
                                       "y_min = {convection = 20}\ny_max = {convection = 20, ambient = 310}\n"
                                       "z_min = {flux = \"-1 kW/m^2\"}"));
    EXPECT_EQ(scenario.boundary[0].kind, FaceSpec::Kind::adiabatic);
    EXPECT_DOUBLE_EQ(scenario.boundary[1].temperature, 298.15);
    EXPECT_EQ(scenario.boundary[2].kind, FaceSpec::Kind::convection);
    EXPECT_EQ(scenario.boundary[2].ambient, 298.15);
    EXPECT_EQ(scenario.boundary[3].ambient, 310.0);
    EXPECT_EQ(scenario.boundary[4].flux, -1000.0);
}

TEST(scenario_read, path_files_and_patterns_give_paths) {
    const std::filesystem::path folder = ::testing::TempDir();
    std::ofstream(folder / "scenario_read_path.txt") << "Mode X Y Z Power Param\n"
                                                        "1 1e-4 1e-4 0 0 0\n"
                                                        "0 3e-4 1e-4 0 120 0.5\n";
    const std::string inline_path = "path = [{move = [\"100 um\", \"100 um\", 0]}, {to = [\"300 um\", \"100 "
                                    "um\", 0], speed = \"0.5 m/s\"}]";
    const Scenario from_file = read_scenario_text(with(inline_path, "path_file = \"scenario_read_path.txt\""),
                                                  {}, "scenario", folder);
    EXPECT_EQ(path_end(from_file.lasers[0].path), Vec3(3e-4, 1e-4, 0.0));
    EXPECT_EQ(from_file.lasers[0].path.segments.back().power, 120.0);

    const Scenario raster = read_scenario_text(
        with(inline_path,
             "pattern = {type = \"raster\", min = [1e-4, 5e-5], max = [3e-4, 1.5e-4], hatch = \"25 um\", "
             "speed = 0.8, angle = \"0 deg\"}\nstart_time = \"1 us\""));
    EXPECT_GE(raster.lasers[0].path.segments.size(), 4u);
    EXPECT_EQ(raster.lasers[0].path.start_time, 1e-6);
}

TEST(scenario_read, materials_keep_the_order_of_the_text) {
    const std::string second =
        with("[material.steel]", "[material.zinc]",
             example.substr(example.find("[material"), example.find("[[body]]") - example.find("[material")));
    const std::string third = with("[material.zinc]", "[material.alloy]", second);
    const Scenario scenario = read_scenario_text(with("[[body]]", second + third + "[[body]]"));
    ASSERT_EQ(scenario.materials.size(), 3u);
    EXPECT_EQ(scenario.materials[0].name, "steel");
    EXPECT_EQ(scenario.materials[1].name, "zinc");
    EXPECT_EQ(scenario.materials[2].name, "alloy");
    EXPECT_EQ(material_index(scenario, "alloy"), 2u);
    EXPECT_THROW(material_index(scenario, "brass"), std::out_of_range);
}

TEST(scenario_read, the_scenarios_that_come_with_the_program_are_valid) {
    const std::filesystem::path folder = MELTSCOPE_SOURCE_DIR "/scenarios";
    const Scenario track = read_scenario(folder / "in625_single_track.toml");
    EXPECT_EQ(track.domain.cell_size, 10e-6);
    EXPECT_TRUE((track.domain.cells() == Index3(200, 50, 28)).all());
    EXPECT_EQ(track.lasers.at(0).power, 179.2);
    EXPECT_EQ(track.lasers.at(0).spot_radius, 85e-6);
    EXPECT_DOUBLE_EQ(path_end_time(track.lasers[0].path), 1.875e-3);
    EXPECT_EQ(track.materials.at(0).name, "in625");
    EXPECT_EQ(track.materials.at(0).density, 7569.92);
    EXPECT_DOUBLE_EQ(track.output.isotherms.at(0), 1563.15);
    EXPECT_NO_THROW(read_scenario(folder / "quick_look.toml"));
}

} // namespace
} // namespace meltscope
