#include "slope_limit.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace meltscope {
namespace {

constexpr double least = 2.0, energy = 5.0, steepest = (energy - least) / slope_reach;

/// The slope (x, y, z, per cell) of a particle of `energy` after it has been shortened.
Vec3 shortened(const Vec3& slope) {
    Gathered<1> gathered{};
    gathered.x[0] = Lanes(slope[0]);
    gathered.y[0] = Lanes(slope[1]);
    gathered.z[0] = Lanes(slope[2]);
    std::array<double, lane_count> energies;
    energies.fill(energy);
    shorten_slopes(Lanes(least), energies.data(), gathered);
    return {gathered.x[0][0], gathered.y[0][0], gathered.z[0][0]};
}

const std::array<Vec3, 4> directions{Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1, 1, 1).normalized(),
                                     Vec3(-0.3, 0.2, 0.7).normalized()};

TEST(SlopeLimit, what_is_too_steep_reaches_the_least_energy_where_it_may_whichever_way_it_points) {
    for (const Vec3& direction : directions)
        EXPECT_LT((shortened(3.0 * steepest * direction) - steepest * direction).norm(), 1e-12);
}

TEST(SlopeLimit, what_is_not_too_steep_stays_as_it_is) {
    for (const Vec3& direction : directions)
        EXPECT_EQ(shortened(0.999 * steepest * direction), 0.999 * steepest * direction);
}

} // namespace
} // namespace meltscope
