#include "meltscope/run/measure.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace meltscope;

namespace {

/// A half ellipsoid of melt below z = 0, its long axis turned by `angle` from x. T falls quadratically from
/// 3000 K at the centre through 1500 K at the ellipsoid.
struct EllipsoidalPool {
    Vec3 centre;  ///< in cells
    Vec3 half;    ///< half length, half width, depth, in cells
    double angle; ///< rad
    double isotherm = 1500.0;

    Vec3 along() const { return {std::cos(angle), std::sin(angle), 0.0}; }

    PoolFigures measure() const {
        const NodeLattice nodes{Vec3::Zero(), 1.0, {71, 67, 25}};
        const double surface = 20.3;
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
        return measure_pool(nodes, temperature, phi, isotherm, along());
    }
};

class PoolOfAnyPlaceAndDirection : public testing::TestWithParam<double> {};

} // namespace

TEST_P(PoolOfAnyPlaceAndDirection, is_measured_within_a_fifth_of_a_cell) {
    for (const double shift : {0.0, 0.25, 0.5, 0.8}) {
        const EllipsoidalPool pool{{35.0 + shift, 33.0 - 0.7 * shift, 0.0}, {20.0, 7.0, 5.0}, GetParam()};
        const PoolFigures figures = pool.measure();
        EXPECT_NEAR(figures.length, 40.0, 0.2) << "shift " << shift;
        EXPECT_NEAR(figures.width, 14.0, 0.2) << "shift " << shift;
        EXPECT_NEAR(figures.depth, 5.0, 0.2) << "shift " << shift;
        const double volume = 2.0 / 3.0 * M_PI * 20.0 * 7.0 * 5.0;
        // Linear interpolation cuts off the rounded edge: 3 % at a depth of five cells.
        EXPECT_NEAR(figures.volume / volume, 1.0, 0.04) << "shift " << shift;
    }
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
