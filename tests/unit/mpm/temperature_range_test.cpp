#include "meltscope/mpm/temperature_range.hpp"

#include "meltscope/mpm/thermal_step.hpp"
#include "reference/driver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope {
namespace {

/// A ball whose nodes carry a field that is steep towards its upper right.
struct Ball {
    Grid grid = make_grid(Vec3::Zero(), 0.1, {20, 11, 12});
    Particles particles;
    Nodes nodes;

    explicit Ball(double jitter = 0.0) {
        ParticleList list = verification::lattice_points(
            grid, 2, [](const Vec3& x) { return (x - Vec3(0.62, 0.53, 0.57)).norm() < 0.31; });
        list.mass = list.volume;
        for (std::int64_t q = 0; q < list.size(); ++q)
            list.position[q] += jitter * Vec3(std::sin(3.0 * q), std::cos(5.0 * q), std::sin(7.0 * q));
        particles = make_particles(grid, std::move(list), 2);
        nodes = make_nodes(grid, particles, 1, {});
        for (std::int64_t i = 0; i < grid.size; ++i)
            if (nodes.mass[i] > 0.0) {
                const Vec3 x = grid.position(i % grid.stride_y - 1, i % grid.stride_z / grid.stride_y - 1,
                                             i / grid.stride_z - 1);
                nodes.temperature[i] = 1500.0 + 2000.0 * x[0] - 1400.0 * x[1] + 900.0 * std::sin(9.0 * x[2]);
            }
    }

    double hottest_node() const {
        return *std::max_element(nodes.temperature.begin(), nodes.temperature.end());
    }
};

TEST(TemperatureRange, is_that_of_the_particles_and_not_of_their_nodes) {
    for (const double jitter : {0.0, 0.004}) {
        const Ball ball(jitter);
        const Field t = particle_temperatures(ball.grid, ball.particles, ball.nodes);
        double coldest = 1e300, hottest = -1e300;
        for (const std::int64_t at : ball.particles.layout.place) {
            coldest = std::min(coldest, t[at]);
            hottest = std::max(hottest, t[at]);
        }
        ASSERT_GT(ball.hottest_node(), hottest + 100.0);
        const TemperatureRange range = particle_temperature_range(ball.grid, ball.particles, ball.nodes);
        EXPECT_TRUE(range.finite);
        EXPECT_LE(range.coldest, coldest);
        EXPECT_GT(range.coldest, coldest - 1.0);
        EXPECT_GE(range.hottest, hottest);
        EXPECT_LT(range.hottest, hottest + 1.0);
    }
}

TEST(TemperatureRange, round_off_about_a_round_temperature_is_one_kelvin) {
    Ball ball;
    for (std::int64_t i = 0; i < ball.grid.size; ++i)
        if (ball.nodes.mass[i] > 0.0)
            ball.nodes.temperature[i] = 300.0 + (i % 2 ? 1e-11 : -1e-11);
    const TemperatureRange range = particle_temperature_range(ball.grid, ball.particles, ball.nodes);
    EXPECT_LT(range.hottest - range.coldest, 1.5);
}

TEST(TemperatureRange, notices_what_is_not_a_number_and_what_is_infinite) {
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        Ball ball;
        ball.nodes.temperature[ball.grid.index(6, 5, 6)] = bad;
        EXPECT_FALSE(particle_temperature_range(ball.grid, ball.particles, ball.nodes).finite);
    }
}

} // namespace
} // namespace meltscope
