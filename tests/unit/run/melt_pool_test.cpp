#include "meltscope/run/measure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>

using namespace meltscope;

namespace {

/// A half ellipsoid of melt below z = 0, its long axis turned by `angle` from x. T falls quadratically from
/// 3000 K at the centre through 1500 K at the ellipsoid.
struct EllipsoidalPool {
    Vec3 centre;  ///< in cells
    Vec3 half;    ///< half length, half width, depth, in cells
    double angle; ///< rad
    double isotherm = 1500.0;
    double surface = 20.3; ///< height, in cells

    Vec3 along() const { return {std::cos(angle), std::sin(angle), 0.0}; }

    PoolFigures measure() const {
        const NodeLattice nodes{Vec3::Zero(), 1.0, {71, 67, 25}};
        std::vector<double> temperature, phi;
        for (std::int64_t k = 0; k < nodes.count[2]; ++k)
            for (std::int64_t j = 0; j < nodes.count[1]; ++j)
                for (std::int64_t i = 0; i < nodes.count[0]; ++i) {
                    const Vec3 p =
                        Vec3(double(i), double(j), double(k)) - Vec3(centre.x(), centre.y(), surface);
                    const Vec3 across(-along().y(), along().x(), 0.0);
                    const Vec3 q = Vec3(p.dot(along()), p.dot(across), p.z()).cwiseQuotient(half);
                    temperature.push_back(3000.0 - 1500.0 * q.squaredNorm());
                    phi.push_back(p.z());
                }
        BeamSnapshot beam;
        beam.scan_direction = along();
        return measure_pools(nodes, temperature, phi, isotherm, {beam}).of_beams.front();
    }
};

} // namespace

class PoolOfAnyPlaceAndDirection : public testing::TestWithParam<double> {};

TEST_P(PoolOfAnyPlaceAndDirection, is_measured_within_a_fifth_of_a_cell) {
    double worst = 0.0;
    const auto check = [&](const Vec3& half, double surface) {
        for (const double shift : {0.0, 0.25, 0.5, 0.8}) {
            EllipsoidalPool pool{{35.0 + shift, 33.0 - 0.7 * shift, 0.0}, half, GetParam()};
            pool.surface = surface;
            const PoolFigures figures = pool.measure();
            SCOPED_TRACE(testing::Message() << "surface " << surface << ", shift " << shift);
            EXPECT_NEAR(figures.length, 2.0 * half[0], 0.2);
            EXPECT_NEAR(figures.width, 2.0 * half[1], 0.2);
            EXPECT_NEAR(figures.depth, half[2], 0.2);
            worst = std::max({worst, std::abs(figures.length - 2.0 * half[0]),
                              std::abs(figures.width - 2.0 * half[1]), std::abs(figures.depth - half[2])});
            const double volume = 2.0 / 3.0 * M_PI * half.prod();
            // Linear interpolation cuts off the rounded edge: 3 % at a depth of five cells.
            EXPECT_NEAR(figures.volume / volume, 1.0, 0.04);
        }
    };
    // The surface in a plane of nodes, with the round-off that it has in a run, and near one.
    for (const double surface : {20.0, 20.0 + 1e-13, 20.0 - 1e-13, 20.3})
        check({20.0, 7.0, 5.0}, surface);
    // Anywhere between two: linear interpolation errs by T'' / 8 across a cell, which at either tip of the
    // shallow pool above, (120 + 61) / 8 K where T falls by 150 K a cell, is 0.15 cells. Eight cells deep it
    // is half of that.
    for (const double surface : {20.5, 20.7, 20.95})
        check({20.0, 9.0, 8.0}, surface);
    RecordProperty("largest_error_in_cells", std::to_string(worst));
    std::cout << "largest error " << worst << " cells\n";
}

INSTANTIATE_TEST_SUITE_P(melt_pool, PoolOfAnyPlaceAndDirection, testing::Values(0.0, 0.3, M_PI / 4.0, 1.2));

TEST(melt_pool, has_no_size_where_nothing_is_that_hot) {
    EllipsoidalPool pool{{35.0, 33.0, 0.0}, {20.0, 7.0, 5.0}, 0.0};
    pool.isotherm = 3100.0;
    const PoolFigures figures = pool.measure();
    EXPECT_EQ(figures.length, 0.0);
    EXPECT_EQ(figures.width, 0.0);
    EXPECT_EQ(figures.depth, 0.0);
    EXPECT_EQ(figures.volume, 0.0);
}

TEST(melt_pool, ends_at_the_free_surface) {
    // The same ellipsoid with the isotherm far out: what lies above the surface does not count.
    EllipsoidalPool pool{{35.0, 33.0, 0.0}, {20.0, 7.0, 5.0}, 0.0};
    pool.isotherm = 2625.0; // q = 1/2
    EXPECT_NEAR(pool.measure().depth, 2.5, 0.2);
}

namespace {

/// Balls of melt in a block, each a hot ball of a given radius that falls through the isotherm (1500 K)
/// there.
struct HotBalls {
    struct Ball {
        Vec3 centre;
        double radius;
    };
    std::vector<Ball> balls; ///< in cells
    std::vector<BeamSnapshot> beams = {};

    IsothermPools measure() const {
        const NodeLattice nodes{Vec3::Zero(), 1.0, {61, 31, 21}};
        std::vector<double> temperature, phi;
        for (std::int64_t k = 0; k < nodes.count[2]; ++k)
            for (std::int64_t j = 0; j < nodes.count[1]; ++j)
                for (std::int64_t i = 0; i < nodes.count[0]; ++i) {
                    double hottest = 300.0;
                    for (const Ball& ball : balls) {
                        const double r = (Vec3(double(i), double(j), double(k)) - ball.centre).norm();
                        hottest = std::max(hottest, 1500.0 + 100.0 * (ball.radius - r));
                    }
                    temperature.push_back(hottest);
                    phi.push_back(double(k) - 25.0);
                }
        return measure_pools(nodes, temperature, phi, 1500.0, beams);
    }

    void shine(const Vec3& position, const Vec3& along) {
        BeamSnapshot beam;
        beam.position = position;
        beam.scan_direction = along;
        beam.spot_radius = 2.0;
        beams.push_back(beam);
    }
};

} // namespace

TEST(melt_pools, are_told_apart_if_a_cell_between_them_is_cold) {
    HotBalls two{{{{15, 15, 10}, 5}, {{26, 15, 10}, 4}}}; // 2 cells of cold between them
    IsothermPools found = two.measure();
    ASSERT_EQ(found.pools.size(), 2U);
    EXPECT_NEAR(found.pools[0].figures.length, 10.0, 0.2); // the largest first
    EXPECT_NEAR(found.pools[1].figures.length, 8.0, 0.2);
    EXPECT_LT((found.pools[0].center - Vec3(15, 15, 10)).norm(), 0.2);
    EXPECT_LT((found.pools[1].center - Vec3(26, 15, 10)).norm(), 0.2);
    EXPECT_NEAR(found.pools[0].peak, 2000.0, 1e-9);
    EXPECT_NEAR(found.pools[1].peak, 1900.0, 1e-9);
    two.balls[1].centre.x() = 23; // the balls overlap
    found = two.measure();
    ASSERT_EQ(found.pools.size(), 1U);
    EXPECT_NEAR(found.pools[0].figures.length, 17.0, 0.2);
}

TEST(melt_pools, belong_to_the_beam_that_shines_on_them_in_its_own_frame) {
    HotBalls scene{{{{15, 15, 10}, 5}, {{17, 15, 10}, 5}, {{45, 15, 10}, 4}}};
    scene.shine({44, 15, 25}, Vec3::UnitY());
    scene.shine({16, 15, 25}, Vec3::UnitX());
    const IsothermPools found = scene.measure();
    ASSERT_EQ(found.pools.size(), 2U);
    EXPECT_EQ(found.pools[0].beams, std::vector<int>{1});
    EXPECT_EQ(found.pools[1].beams, std::vector<int>{0});
    EXPECT_NEAR(found.of_beams[0].length, 8.0, 0.2);
    EXPECT_NEAR(found.of_beams[1].length, 12.0, 0.2);
    EXPECT_NEAR(found.of_beams[1].width, 10.0, 0.2);
}

TEST(melt_pools, that_two_beams_share_are_measured_along_each) {
    HotBalls scene{{{{28, 15, 10}, 5}, {{32, 15, 10}, 5}}};
    scene.shine({28, 15, 25}, Vec3::UnitX());
    scene.shine({32, 15, 25}, Vec3::UnitY());
    const IsothermPools found = scene.measure();
    ASSERT_EQ(found.pools.size(), 1U);
    EXPECT_EQ(found.pools[0].beams, (std::vector<int>{0, 1}));
    EXPECT_NEAR(found.of_beams[0].length, 14.0, 0.2);
    EXPECT_NEAR(found.of_beams[1].length, 10.0, 0.2);
    EXPECT_NEAR(found.of_beams[1].width, 14.0, 0.2);
}

TEST(melt_pools, of_another_beam_are_not_ones_own_however_near) {
    HotBalls scene{{{{15, 15, 10}, 5}}};
    scene.shine({15, 15, 25}, Vec3::UnitX());
    scene.shine({30, 15, 25}, Vec3::UnitX());
    const IsothermPools found = scene.measure();
    EXPECT_NEAR(found.of_beams[0].length, 10.0, 0.2);
    EXPECT_EQ(found.of_beams[1].length, 0.0);
    // Alone, the beam that has moved on keeps the pool that it left behind.
    scene.beams.erase(scene.beams.begin());
    EXPECT_NEAR(scene.measure().of_beams[0].length, 10.0, 0.2);
}

TEST(melt_pools, under_the_spot_the_largest_is_the_beams_own) {
    HotBalls scene{{{{15, 15, 10}, 5}, {{22.5, 15, 10}, 1}}};
    scene.shine({21, 15, 25}, Vec3::UnitX()); // nearer to the speck, and within reach of both
    scene.beams[0].spot_radius = 2.5;
    const IsothermPools found = scene.measure();
    ASSERT_EQ(found.pools.size(), 2U);
    EXPECT_NEAR(found.of_beams[0].length, 10.0, 0.2);
}
