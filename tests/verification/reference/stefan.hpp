#pragma once

#include <cmath>
#include <numbers>

namespace meltscope::verification {

/// Neumann's solution of two-phase melting of a half space (V. Alexiades, A. D. Solomon, Mathematical
/// Modeling of Melting and Freezing Processes, 1993, 2.2): the wall x = 0 is held above the melting point
/// since t = 0, the front is at 2 lambda sqrt(alpha_l t).
struct Stefan {
    double liquid = 1.0; ///< St_l = c_l (T_wall - T_m)/L
    double solid = 1.0;  ///< St_s = c_s (T_m - T_0)/L; zero for the one-phase problem
    double nu = 1.0;     ///< sqrt(alpha_l/alpha_s)

    /// St_l/(e^{l^2} erf l) - St_s/(nu e^{nu^2 l^2} erfc(nu l)) - l sqrt(pi), which falls with l.
    double residual(double l) const {
        const double a = nu * l;
        return liquid / (std::exp(l * l) * std::erf(l)) - solid / (nu * std::exp(a * a) * std::erfc(a)) -
               l * std::sqrt(std::numbers::pi);
    }

    /// lambda, by bisection.
    double root() const {
        double low = 1e-9, high = 4.0;
        for (int i = 0; i < 200; ++i) {
            const double middle = 0.5 * (low + high);
            (residual(middle) > 0.0 ? low : high) = middle;
        }
        return 0.5 * (low + high);
    }
};

/// T in K at x (m) for equal diffusivities alpha (m^2/s) of both phases.
inline double stefan_temperature(double x, double t, double alpha, double lambda, double wall, double melting,
                                 double start) {
    const double eta = x / (2.0 * std::sqrt(alpha * t));
    if (eta < lambda)
        return wall - (wall - melting) * std::erf(eta) / std::erf(lambda);
    return start + (melting - start) * std::erfc(eta) / std::erfc(lambda);
}

} // namespace meltscope::verification
