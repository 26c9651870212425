#include "meltscope/beam/profile.hpp"

#include "meltscope/constants.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <stdexcept>

namespace meltscope {
namespace {

Laser beam(BeamProfile profile, double order = 4.0) {
    Laser laser;
    laser.power = 195.0;
    laser.spot_radius = 50e-6;
    laser.profile = profile;
    laser.super_gaussian_order = order;
    return laser;
}

/// Power through the plane across the beam, by the midpoint rule in the radius.
double integrated_power(const Laser& laser) {
    const double cutoff = cutoff_radius(laser);
    const int rings = 20000;
    const double width = cutoff / rings;
    const BeamShape shape = beam_shape(laser);
    double sum = 0.0;
    for (int i = 0; i < rings; ++i) {
        const double r = (i + 0.5) * width;
        sum += flux(shape, laser.power, r * r) * 2.0 * constants::pi * r * width;
    }
    return sum;
}

TEST(BeamProfile, gaussian_beam_integrates_to_its_power) {
    const double power = integrated_power(beam(BeamProfile::gaussian));
    EXPECT_NEAR(power, 195.0, 195.0 * 1.5e-6);
    EXPECT_LT(power, 195.0) << "the share beyond the cutoff is missing";
}

TEST(BeamProfile, top_hat_integrates_to_its_power_and_is_level) {
    const Laser laser = beam(BeamProfile::top_hat);
    EXPECT_NEAR(integrated_power(laser), 195.0, 195.0 * 1e-6);
    EXPECT_EQ(flux(laser, 0.0), flux(laser, 49e-6));
    EXPECT_EQ(flux(laser, 51e-6), 0.0);
}

TEST(BeamProfile, super_gaussian_integrates_to_its_power_for_any_order) {
    for (const double order : {0.8, 1.0, 1.5, 2.0, 3.0, 4.0, 10.0, 40.0}) {
        EXPECT_NEAR(integrated_power(beam(BeamProfile::super_gaussian, order)), 195.0, 195.0 * 3e-6) << order;
    }
}

TEST(BeamProfile, super_gaussian_of_order_two_is_the_gaussian) {
    for (const double r : {0.0, 20e-6, 50e-6, 100e-6}) {
        const double expected = flux(beam(BeamProfile::gaussian), r);
        EXPECT_NEAR(flux(beam(BeamProfile::super_gaussian, 2.0), r), expected, 1e-12 * expected);
    }
}

TEST(BeamProfile, gaussian_flux_falls_to_one_part_in_e_squared_at_the_spot_radius) {
    const Laser laser = beam(BeamProfile::gaussian);
    EXPECT_NEAR(flux(laser, 50e-6) / flux(laser, 0.0), std::exp(-2.0), 1e-14);
    EXPECT_NEAR(flux(laser, 0.0), 2.0 * 195.0 / (constants::pi * 50e-6 * 50e-6), 1e-2);
}

TEST(BeamProfile, distance_is_taken_from_the_axis_of_a_slanted_beam) {
    const Vec3 direction = Vec3(0.3, -0.5, -0.8).normalized();
    const Vec3 on_axis(1.0, 2.0, 3.0);
    const Vec3 sideways = direction.cross(Vec3::UnitX()).normalized();
    const Vec3 point = on_axis + 0.7 * direction + 0.02 * sideways;
    EXPECT_NEAR(axis_distance_squared(point, on_axis, direction), 4e-4, 1e-15);
}

TEST(BeamProfile, volumetric_source_integrates_to_its_power_on_the_half_space) {
    Laser laser = beam(BeamProfile::volumetric);
    laser.volume_depth = 80e-6;
    laser.volume_width = 30e-6;
    laser.direction = Vec3(0.2, 0.1, -1.0).normalized();
    BeamPosition position;
    position.position = Vec3(1e-3, 2e-3, 0.0);
    position.scan_direction = Vec3(1.0, 1.0, 0.0).normalized();
    const VolumeSource source = volume_source(laser, position);
    EXPECT_NEAR(source.along.dot(source.across), 0.0, 1e-15);
    EXPECT_NEAR(source.inward.dot(source.along), 0.0, 1e-15);
    const int n = 60;
    double sum = 0.0;
    for (int i = -n; i < n; ++i) {
        for (int j = -n; j < n; ++j) {
            for (int k = -4; k < n; ++k) { // some of it above the surface, where nothing may be
                const double s = 3.0 / n;
                const Vec3 point = source.origin + s * ((i + 0.5) * source.a * source.along +
                                                        (j + 0.5) * source.b * source.across +
                                                        (k + 0.5) * source.c * source.inward);
                sum += power_density(source, laser.power, point) * s * s * s * source.a * source.b * source.c;
            }
        }
    }
    EXPECT_NEAR(sum, 195.0, 195.0 * 1e-5);
}

TEST(BeamProfile, volumetric_source_of_a_resting_beam_is_defined) {
    Laser laser = beam(BeamProfile::volumetric);
    laser.volume_depth = 80e-6;
    const VolumeSource source = volume_source(laser, BeamPosition{});
    EXPECT_NEAR(source.along.norm(), 1.0, 1e-15);
    EXPECT_EQ(source.b, laser.spot_radius);
}

TEST(BeamProfile, meaningless_shapes_are_refused) {
    Laser laser = beam(BeamProfile::gaussian);
    laser.spot_radius = 0.0;
    EXPECT_THROW(beam_shape(laser), std::invalid_argument);
    EXPECT_THROW(beam_shape(beam(BeamProfile::super_gaussian, 0.0)), std::invalid_argument);
    EXPECT_THROW(beam_shape(beam(BeamProfile::volumetric)), std::invalid_argument);
    EXPECT_THROW(volume_source(beam(BeamProfile::volumetric), BeamPosition{}), std::invalid_argument);
}

} // namespace
} // namespace meltscope
