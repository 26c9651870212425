#include "meltscope/beam/volume_heating.hpp"

#include "lattice_block.hpp"

#include "meltscope/constants.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <numeric>

namespace meltscope {
namespace {

constexpr double dx = 10e-6;

LatticeBody plate() {
    return make_lattice_body(plain_steel(), dx, {40, 40, 20}, 300.0,
                             [](const Vec3& x) { return x.z() < 16.0 * dx; });
}

Laser volumetric() {
    Laser laser;
    laser.power = 200.0;
    laser.absorptivity = 0.35;
    laser.profile = BeamProfile::volumetric;
    laser.spot_radius = 50e-6;
    laser.volume_width = 40e-6;
    laser.volume_depth = 45e-6;
    return laser;
}

BeamPosition at(double x, double y, double z) {
    BeamPosition beam;
    beam.position = Vec3(x, y, z);
    beam.scan_direction = Vec3::UnitX();
    beam.on = true;
    return beam;
}

Absorption shine(LatticeBody& body, const BeamPosition& beam, double dt) {
    const Laser laser = volumetric();
    return deposit_volume(body.grid, body.particles, make_light_map(body.grid, body.surface, laser.direction),
                          laser, beam, laser.power, dt, body.nodes);
}

double sum(const Field& field) {
    return std::accumulate(field.begin(), field.end(), 0.0);
}

TEST(VolumeHeating, a_plate_takes_exactly_the_absorbed_power) {
    LatticeBody body = plate();
    const Absorption a = shine(body, at(20 * dx, 20 * dx, 16 * dx), 2e-6);
    EXPECT_DOUBLE_EQ(a.absorbed, 0.35 * 200.0);
    EXPECT_EQ(a.missed, 0.0);
    EXPECT_NEAR(a.scale, 1.0, 0.01);
    EXPECT_NEAR(sum(body.nodes.increment), a.absorbed * 2e-6, 1e-13 * a.absorbed * 2e-6);
}

TEST(VolumeHeating, the_heat_is_as_deep_and_wide_as_the_source) {
    LatticeBody body = plate();
    const Vec3 centre(20 * dx, 20 * dx, 16 * dx);
    shine(body, at(centre.x(), centre.y(), centre.z()), 1.0);
    double depth = 0.0, along = 0.0, across = 0.0;
    for (std::int64_t k = -1; k <= 21; ++k)
        for (std::int64_t j = -1; j <= 41; ++j)
            for (std::int64_t i = -1; i <= 41; ++i) {
                const double joule = body.nodes.increment[body.grid.index(i, j, k)] / 70.0;
                const Vec3 r = body.grid.position(i, j, k) - centre;
                depth -= joule * r.z();
                along += joule * r.x() * r.x();
                across += joule * r.y() * r.y();
            }
    // Means of exp(-2 z^2/c^2), z > 0, and variances of exp(-2 x^2/a^2); a node's weight adds dx^2/4 to a
    // variance.
    EXPECT_NEAR(depth, 45e-6 / std::sqrt(2.0 * constants::pi), 0.02 * depth);
    EXPECT_NEAR(along, 50e-6 * 50e-6 / 4.0 + dx * dx / 4.0, 0.02 * along);
    EXPECT_NEAR(across, 40e-6 * 40e-6 / 4.0 + dx * dx / 4.0, 0.02 * across);
}

TEST(VolumeHeating, light_beside_the_plate_is_missed_and_not_spread_over_the_rest) {
    LatticeBody body = make_lattice_body(plain_steel(), dx, {40, 40, 20}, 300.0, [](const Vec3& x) {
        return x.z() < 16.0 * dx && x.x() < 20.0 * dx;
    });
    const Absorption a = shine(body, at(20 * dx, 20 * dx, 16 * dx), 2e-6);
    EXPECT_NEAR(a.absorbed, 0.5 * 70.0, 0.05 * 70.0);
    EXPECT_NEAR(a.missed, 200.0 - a.absorbed / 0.35, 1e-9);
    EXPECT_NEAR(a.scale, 1.0, 0.05);
}

TEST(VolumeHeating, a_beam_that_meets_nothing_is_missed) {
    LatticeBody body = make_lattice_body(plain_steel(), dx, {40, 40, 20}, 300.0,
                                         [](const Vec3& x) { return x.x() < 5.0 * dx; });
    const Absorption a = shine(body, at(30 * dx, 20 * dx, 16 * dx), 2e-6);
    EXPECT_EQ(a.absorbed, 0.0);
    EXPECT_EQ(a.missed, 200.0);
    EXPECT_EQ(sum(body.nodes.increment), 0.0);
}

TEST(VolumeHeating, sums_do_not_depend_on_the_number_of_threads) {
    LatticeBody one = plate(), three = plate();
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    shine(one, at(17.3 * dx, 21.1 * dx, 16 * dx), 1.0);
    omp_set_num_threads(3);
    shine(three, at(17.3 * dx, 21.1 * dx, 16 * dx), 1.0);
    omp_set_num_threads(threads);
    EXPECT_EQ(one.nodes.increment, three.nodes.increment);
}

} // namespace
} // namespace meltscope
