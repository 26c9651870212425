#include "block.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace meltscope {
namespace {

using namespace test;

/// Half a box of steel at 300 K under a laser whose sigma is one and a half cells.
Simulation under_a_narrow_beam() {
    RunParameters parameters = block_parameters();
    Laser laser;
    laser.power = 20.0;
    laser.absorptivity = 0.5;
    laser.spot_radius = 30e-6;
    laser.path.start = Vec3(40e-6, 40e-6, 0.0);
    append_line(laser.path, Vec3(90e-6, 40e-6, 0.0), 0.8);
    parameters.lasers = {laser};
    const Grid grid = block_grid();
    return make_simulation(parameters, grid, block_particles(grid, 40e-6, 300.0), 2);
}

double coldest(const Simulation& s) {
    const Field t = particle_temperatures(s.grid, s.particles, s.nodes);
    double least = 1e300;
    for (const std::int64_t at : s.particles.layout.place)
        least = std::min(least, t[at]);
    return least;
}

TEST(LeastTemperature, heat_that_goes_into_a_cold_plate_cools_no_particle) {
    Simulation s = under_a_narrow_beam();
    double least = 300.0, most = 300.0;
    for (int n = 0; n < 30; ++n) {
        advance(s, 1.0);
        least = std::min(least, coldest(s));
        most = std::max(most, s.peak_temperature);
    }
    EXPECT_GT(most, 2000.0);
    EXPECT_GT(least, 300.0 - 1e-3 * (most - 300.0));
    balance(s);
    EXPECT_LT(std::abs(s.ledger.relative_residual()), 1e-13);
}

TEST(LeastTemperature, is_that_of_whatever_can_cool_the_material) {
    Simulation s = steel_block(0.5, 400.0);
    EXPECT_NEAR(s.least_temperature, 400.0, 0.01);
    s.parameters.physics.ambient = 290.0;
    update_losses(s);
    EXPECT_NEAR(s.least_temperature, 400.0, 0.01) << "no loss is on";
    s.parameters.physics.convection = 10.0;
    update_losses(s);
    EXPECT_EQ(s.least_temperature, 290.0);
    FaceCondition& floor = s.parameters.boundary[4];
    floor.kind = FaceCondition::Kind::fixed_temperature;
    floor.temperature = 280.0;
    update_boundary(s);
    EXPECT_EQ(s.least_temperature, 280.0);
    floor.temperature = 350.0; // what has been cold may still be
    update_boundary(s);
    EXPECT_EQ(s.least_temperature, 280.0);
    floor.kind = FaceCondition::Kind::fixed_flux;
    floor.flux = -1e6;
    update_boundary(s);
    EXPECT_EQ(s.least_temperature, 0.0);
}

/// Temperatures in K at the nodes up from a face that is suddenly held 100 K below the block.
std::vector<double> profile_at_a_colder_face(bool bounded) {
    Simulation s = steel_block(1.0, 400.0);
    FaceCondition& floor = s.parameters.boundary[4];
    floor.kind = FaceCondition::Kind::fixed_temperature;
    floor.temperature = 300.0;
    update_boundary(s);
    if (!bounded)
        s.least_temperature = 0.0;
    for (int n = 0; n < 20; ++n)
        advance(s, 1.0);
    std::vector<double> profile;
    for (std::int64_t k = 0; k <= s.grid.cells[2]; ++k)
        profile.push_back(s.nodes.temperature[s.grid.index(4, 4, k)]);
    return profile;
}

TEST(LeastTemperature, leaves_the_profile_at_a_colder_face_as_it_is) {
    const std::vector<double> with = profile_at_a_colder_face(true),
                              without = profile_at_a_colder_face(false);
    EXPECT_LT(with[4], 390.0);
    for (std::size_t k = 0; k < with.size(); ++k)
        EXPECT_NEAR(with[k], without[k], 1e-9) << k;
}

} // namespace
} // namespace meltscope
