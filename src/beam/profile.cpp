#include "meltscope/beam/profile.hpp"

#include "meltscope/constants.hpp"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace meltscope {

namespace {

using constants::pi;

void require_positive(double value, const char* name) {
    if (!(std::isfinite(value) && value > 0.0)) {
        throw std::invalid_argument(fmt::format("the {} of a laser must be above zero, not {}", name, value));
    }
}

/// Least x at which a bound on the regularised upper incomplete gamma function Q(s, x) is the dropped share.
/// Bound (NIST DLMF 8.10): Gamma(s, x) <= x^(s-1) e^-x max(1, 1/(1 - (s-1)/x)) for x > s - 1.
double gamma_tail(double s) {
    const auto bound = [s](double x) {
        const double excess = std::max(0.0, (s - 1.0) / x);
        return std::exp((s - 1.0) * std::log(x) - x - std::lgamma(s)) / (1.0 - excess);
    };
    double low = std::max(1e-12, 2.0 * (s - 1.0)); // from here on the bound falls
    double high = 2.0 * low + 1.0;
    while (bound(high) > dropped_power_share) {
        high *= 2.0;
    }
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (bound(middle) > dropped_power_share ? low : high) = middle;
    }
    return high;
}

} // namespace

double cutoff_radius(const Laser& laser) {
    require_positive(laser.spot_radius, "spot radius");
    switch (laser.profile) {
    case BeamProfile::gaussian: // the share beyond r is exp(-2 r^2/R^2)
        return laser.spot_radius * std::sqrt(-0.5 * std::log(dropped_power_share));
    case BeamProfile::super_gaussian: // it is Q(2/k, 2 (r/R)^k)
        require_positive(laser.super_gaussian_order, "super-Gaussian order");
        return laser.spot_radius *
               std::pow(0.5 * gamma_tail(2.0 / laser.super_gaussian_order), 1.0 / laser.super_gaussian_order);
    case BeamProfile::top_hat:
        return laser.spot_radius;
    case BeamProfile::volumetric:
        break;
    }
    throw std::invalid_argument("a volumetric beam has no surface flux");
}

BeamShape beam_shape(const Laser& laser) {
    const double cutoff = cutoff_radius(laser);
    const double area = pi * laser.spot_radius * laser.spot_radius;
    BeamShape shape;
    shape.profile = laser.profile;
    shape.inverse_radius_squared = 1.0 / (laser.spot_radius * laser.spot_radius);
    shape.cutoff_squared = cutoff * cutoff;
    if (laser.profile == BeamProfile::top_hat) {
        shape.peak_per_watt = 1.0 / area;
        return shape;
    }
    const double k = laser.profile == BeamProfile::gaussian ? 2.0 : laser.super_gaussian_order;
    shape.half_order = 0.5 * k;
    shape.peak_per_watt = 0.5 * k * std::pow(2.0, 2.0 / k) / (area * std::tgamma(2.0 / k));
    return shape;
}

double flux(const Laser& laser, double distance) {
    return flux(beam_shape(laser), laser.power, distance * distance);
}

VolumeSource volume_source(const Laser& laser, const BeamPosition& beam) {
    require_positive(laser.spot_radius, "spot radius");
    require_positive(laser.volume_depth, "volume depth");
    VolumeSource source;
    source.origin = beam.position;
    source.inward = laser.direction.normalized();
    const Vec3 sideways = beam.scan_direction - beam.scan_direction.dot(source.inward) * source.inward;
    // A beam that dwells, or moves along itself, has no scan direction: x stands in, or y for a beam along x.
    const bool moves = sideways.norm() > 1e-9;
    const Vec3 axis = std::abs(source.inward.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
    const Vec3 chosen = axis - axis.dot(source.inward) * source.inward;
    source.along = (moves ? sideways : chosen).normalized();
    source.across = source.inward.cross(source.along);
    source.a = laser.spot_radius;
    source.b = laser.volume_width > 0.0 ? laser.volume_width : laser.spot_radius;
    source.c = laser.volume_depth;
    source.peak_per_watt = 4.0 * std::sqrt(2.0) / (std::pow(pi, 1.5) * source.a * source.b * source.c);
    // In units of a, b, c the share beyond s is erfc(s sqrt 2) + s sqrt(8/pi) exp(-2 s^2): 7e-7 at 2.8.
    source.cutoff = 2.8;
    return source;
}

} // namespace meltscope
