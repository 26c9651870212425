#pragma once

#include "meltscope/vec3.hpp"

#include <cmath>
#include <numbers>

namespace meltscope::verification {

// H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford 1959; the section is given with
// each.

/// Share of a sudden temperature step at x = 0 that has reached x (m) after t (s): erfc(x/(2 sqrt(alpha
/// t))), 2.5.
inline double step_profile(double x, double alpha, double t) {
    return std::erfc(x / (2.0 * std::sqrt(alpha * t)));
}

/// Rise in K at x (m) below the surface of a half space that takes the flux q (W/m^2) since t = 0, 2.9:
/// (2 q/k) sqrt(alpha t/pi) exp(-x^2/(4 alpha t)) - (q x/k) erfc(x/(2 sqrt(alpha t))).
inline double flux_profile(double x, double flux, double conductivity, double alpha, double t) {
    const double length = std::sqrt(alpha * t);
    return flux / conductivity *
           (2.0 * length / std::sqrt(std::numbers::pi) * std::exp(-x * x / (4.0 * length * length)) -
            x * std::erfc(x / (2.0 * length)));
}

/// Rise in K at x (m) below the surface of a half space that takes the flux q (W/m^2) since t = 0 and loses
/// h (W/m^2/K) times its surface's own rise, 2.7 (convection from a medium at q/h):
/// (q/h) [erfc(x/(2 l)) - exp(h x/k + h^2 l^2/k^2) erfc(x/(2 l) + h l/k)], l = sqrt(alpha t).
inline double flux_with_loss_profile(double x, double flux, double loss, double conductivity, double alpha,
                                     double t) {
    const double length = std::sqrt(alpha * t), biot = loss * length / conductivity;
    return flux / loss *
           (std::erfc(x / (2.0 * length)) -
            std::exp(loss * x / conductivity + biot * biot) * std::erfc(x / (2.0 * length) + biot));
}

/// Temperature in K at the plane where two half spaces met at t = 0, each at a temperature of its own, 2.15:
/// (b_1 T_1 + b_2 T_2)/(b_1 + b_2), effusivity b = sqrt(kappa rho c).
inline double contact_temperature(double effusivity_1, double t_1, double effusivity_2, double t_2) {
    return (effusivity_1 * t_1 + effusivity_2 * t_2) / (effusivity_1 + effusivity_2);
}

/// The heat kernel along one axis, exp(-(x - x_0)^2/(4 alpha t))/sqrt(4 pi alpha t), in 1/m, with its images
/// in adiabatic walls at 0 and `length` (m), 10.1 and 14.3.
inline double heat_kernel(double x, double x_0, double length, double alpha, double t) {
    double sum = 0.0;
    for (int n = -4; n <= 4; ++n)
        for (const double image : {x_0 + 2.0 * n * length, -x_0 + 2.0 * n * length})
            sum += std::exp(-(x - image) * (x - image) / (4.0 * alpha * t));
    return sum / std::sqrt(4.0 * std::numbers::pi * alpha * t);
}

/// The same in a box [0, size]: the product over the axes, 1/m^3.
inline double heat_kernel(const Vec3& x, const Vec3& x_0, const Vec3& size, double alpha, double t) {
    return heat_kernel(x[0], x_0[0], size[0], alpha, t) * heat_kernel(x[1], x_0[1], size[1], alpha, t) *
           heat_kernel(x[2], x_0[2], size[2], alpha, t);
}

} // namespace meltscope::verification
