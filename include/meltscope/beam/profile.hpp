#pragma once

#include "meltscope/beam/laser.hpp"

#include <cmath>

namespace meltscope {

/// Largest share of a beam's power that lies beyond its cutoff_radius and is dropped.
inline constexpr double dropped_power_share = 1e-6;

/// A beam's cross-section with what does not change over a step worked out, for hot loops.
/// `flux` integrates to the beam's power over the plane across the beam.
struct BeamShape {
    BeamProfile profile = BeamProfile::gaussian;
    double peak_per_watt = 0.0;          ///< 1/m^2, flux on the axis by power
    double inverse_radius_squared = 0.0; ///< 1/m^2, of the 1/e^2 radius
    double half_order = 1.0;             ///< k/2 in exp(-2 (r^2/R^2)^(k/2))
    double cutoff_squared = 0.0;         ///< m^2, beyond it the flux is zero
};

/// Throws std::invalid_argument for a spot radius or an order that is not above zero and for a volumetric
/// beam, which has no surface flux.
BeamShape beam_shape(const Laser& laser);

/// Distance from the axis (m) beyond which the flux is dropped; at most dropped_power_share lies there.
double cutoff_radius(const Laser& laser);

/// Square of a point's distance (m^2) from the line through `on_axis` along the unit vector `direction`.
inline double axis_distance_squared(const Vec3& point, const Vec3& on_axis, const Vec3& direction) {
    const Vec3 offset = point - on_axis;
    const Vec3 radial = offset - offset.dot(direction) * direction;
    return radial.squaredNorm();
}

/// Incident flux (W/m^2 across the beam, before absorptivity and incidence) at the squared distance from the
/// axis (m^2) of a beam of `power` (W):
///   Gaussian        2 P/(pi R^2) exp(-2 r^2/R^2)
///   top-hat         P/(pi R^2) for r < R
///   super-Gaussian  k 2^(2/k) P/(2 pi R^2 Gamma(2/k)) exp(-2 (r/R)^k), Gaussian for k = 2
inline double flux(const BeamShape& shape, double power, double distance_squared) {
    if (!(distance_squared < shape.cutoff_squared)) {
        return 0.0;
    }
    const double peak = shape.peak_per_watt * power;
    const double relative = distance_squared * shape.inverse_radius_squared;
    switch (shape.profile) {
    case BeamProfile::gaussian:
        return peak * std::exp(-2.0 * relative);
    case BeamProfile::super_gaussian:
        return peak * std::exp(-2.0 * std::pow(relative, shape.half_order));
    default:
        return peak;
    }
}

/// The flux (W/m^2) of the laser's own power at a distance from the axis (m). For single values; see
/// BeamShape.
double flux(const Laser& laser, double distance);

/// The volumetric source of one laser at one instant: a Gaussian in three directions on the half space that
/// the light enters, q = 4 sqrt(2) P/(pi^(3/2) a b c) exp(-2 (x^2/a^2 + y^2/b^2 + z^2/c^2)), z >= 0 the depth
/// below the beam's position: the ellipsoid of Goldak et al. 1984 (Metall. Trans. B 15, 299) with 1/e^2
/// radii.
struct VolumeSource {
    Vec3 origin = Vec3::Zero();   ///< m, where the axis meets the surface
    Vec3 along = Vec3::UnitX();   ///< unit, scan direction as seen along the beam
    Vec3 across = Vec3::UnitY();  ///< unit
    Vec3 inward = -Vec3::UnitZ(); ///< unit, the way the light travels
    double a = 0.0;               ///< m, 1/e^2 radius along
    double b = 0.0;               ///< m, 1/e^2 radius across
    double c = 0.0;               ///< m, 1/e^2 depth
    double peak_per_watt = 0.0;   ///< 1/m^3
    double cutoff = 0.0;          ///< multiple of a, b, c beyond which the source is zero
};

/// Throws std::invalid_argument unless spot radius and depth are above zero.
VolumeSource volume_source(const Laser& laser, const BeamPosition& beam);

/// Power density (W/m^3) at a point (m) of a volumetric beam of `power` (W), before absorptivity.
inline double power_density(const VolumeSource& source, double power, const Vec3& point) {
    const Vec3 offset = point - source.origin;
    const double depth = offset.dot(source.inward) / source.c;
    const double x = offset.dot(source.along) / source.a;
    const double y = offset.dot(source.across) / source.b;
    const double relative = x * x + y * y + depth * depth;
    if (depth < 0.0 || !(relative < source.cutoff * source.cutoff)) {
        return 0.0;
    }
    return source.peak_per_watt * power * std::exp(-2.0 * relative);
}

} // namespace meltscope
