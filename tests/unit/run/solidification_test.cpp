#include "meltscope/run/simulation.hpp"
#include "meltscope/run/solidification.hpp"

#include "block.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <omp.h>

namespace meltscope {
namespace {

/// Puts a temperature field on the nodes of a block and looks at it at the given times.
Solidification look_at(Simulation& block, const std::function<double(const Vec3&, double)>& temperature,
                       const std::vector<double>& times) {
    const auto set = [&](double time) {
        block.time = time;
        block.peak_temperature = 0.0;
        for (std::int64_t k = 0; k <= block.grid.cells[2]; ++k)
            for (std::int64_t j = 0; j <= block.grid.cells[1]; ++j)
                for (std::int64_t i = 0; i <= block.grid.cells[0]; ++i) {
                    const double t = temperature(block.grid.position(i, j, k), time);
                    block.nodes.temperature[block.grid.index(i, j, k)] = t;
                    block.peak_temperature = std::max(block.peak_temperature, t);
                }
    };
    set(times.front());
    Solidification record = begin_solidification(block);
    for (std::size_t n = 1; n < times.size(); ++n) {
        set(times[n]);
        record_solidification(block, record);
    }
    return record;
}

TEST(Solidification, linear_cooling_gives_exact_times_and_rates) {
    Simulation block = test::steel_block();
    const double liquidus = block.eos[0].liquidus, rate = 3e5; // K, K/s
    const auto cooling = [&](const Vec3&, double t) { return liquidus + 100.0 - rate * t; };
    const Solidification record = look_at(block, cooling, {0.0, 1.3e-4, 2.9e-4, 4.1e-4, 6e-4});
    EXPECT_EQ(record.molten, 0);
    ASSERT_EQ(std::int64_t(record.points.size()), block.grid.node_count());
    for (const SolidifiedPoint& p : record.points) {
        EXPECT_EQ(p.melted, 0.0);
        EXPECT_NEAR(p.solidified, 100.0 / rate, 1e-12);
        EXPECT_NEAR(p.cooling_rate, rate, 1e-6 * rate);
    }
}

TEST(Solidification, a_plane_front_has_the_speed_at_which_it_moves) {
    Simulation block = test::steel_block();
    const double liquidus = block.eos[0].liquidus, gradient = 2e6, speed = 0.4; // K, K/m, m/s
    const auto field = [&](const Vec3& x, double t) {
        return liquidus - gradient * (x[0] - 60e-6 + speed * t); // liquid at low x, freezing towards it
    };
    const Solidification record = look_at(block, field, {0.0, 2e-5, 5e-5, 9e-5, 1.2e-4, 1.6e-4});
    EXPECT_FALSE(record.points.empty());
    for (const SolidifiedPoint& p : record.points) {
        EXPECT_NEAR(p.gradient, gradient, 1e-6 * gradient);
        EXPECT_NEAR(p.speed, speed, 1e-6 * speed);
        EXPECT_NEAR(p.solidified, (60e-6 - p.position[0]) / speed, 1e-11);
    }
}

TEST(Solidification, a_node_that_melts_again_has_a_row_for_each_time) {
    Simulation block = test::steel_block();
    const double liquidus = block.eos[0].liquidus;
    const auto zigzag = [&](const Vec3&, double t) {
        const double phase = t * 1e4 - std::floor(t * 1e4);
        return liquidus - 50.0 + 200.0 * std::min(phase, 1.0 - phase); // peaks at +50 K each 100 us
    };
    std::vector<double> times;
    for (int n = 0; n <= 40; ++n)
        times.push_back(n * 5e-6);
    const Solidification record = look_at(block, zigzag, times);
    ASSERT_EQ(std::int64_t(record.points.size()), 2 * block.grid.node_count());
    const SolidifiedPoint& first = record.points.front();
    EXPECT_NEAR(first.melted, 25e-6, 1e-12);
    EXPECT_NEAR(first.solidified, 75e-6, 1e-12);
    EXPECT_NEAR(record.points.back().melted, 125e-6, 1e-12);
}

TEST(Solidification, what_stays_solid_or_liquid_gives_no_row) {
    Simulation block = test::steel_block();
    const double liquidus = block.eos[0].liquidus;
    EXPECT_TRUE(look_at(block, [&](const Vec3&, double t) { return liquidus - 1.0 - 1e5 * t; }, {0.0, 1e-3})
                    .points.empty());
    const Solidification molten =
        look_at(block, [&](const Vec3&, double t) { return liquidus + 1e5 * t; }, {0.0, 1e-3});
    EXPECT_TRUE(molten.points.empty());
    EXPECT_EQ(molten.molten, block.grid.node_count());
}

TEST(Solidification, nodes_outside_the_material_are_left_out) {
    Simulation block = test::steel_block(0.5); // the upper half is empty
    const double liquidus = block.eos[0].liquidus;
    const Solidification record =
        look_at(block, [&](const Vec3&, double t) { return liquidus + 10.0 - 1e5 * t; }, {0.0, 1e-3});
    const std::int64_t planes = block.grid.cells[2] / 2 + 1;
    EXPECT_EQ(std::int64_t(record.points.size()),
              (block.grid.cells[0] + 1) * (block.grid.cells[1] + 1) * planes);
}

} // namespace
} // namespace meltscope
