#pragma once

#include "meltscope/vec3.hpp"

#include <Eigen/Core>

#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

namespace meltscope::verification {

/// A Gaussian beam that moves along x over the surface z = 0 of a body in z < 0: T. W. Eagar, N.-S. Tsai,
/// Welding Journal 62 (1983) 346-s. Constant properties, no losses.
///
/// dT = A P/(pi rho c sqrt(4 pi alpha)) int_0^t s^{-1/2}/(sigma^2 + 2 alpha s)
///      exp[-((x + V s)^2 + y^2)/(2 (sigma^2 + 2 alpha s)) - z^2/(4 alpha s)] ds,
/// x from the beam. The time t since the beam was switched on is kept, so that short runs have an exact
/// answer, and so are the mirror images that adiabatic walls make.
struct EagarTsai {
    double absorbed_power = 1.0; ///< A P, W
    double sigma = 1.0;          ///< m, a quarter of D4sigma
    double speed = 1.0;          ///< V, m/s
    double diffusivity = 1.0;    ///< alpha, m^2/s
    double heat_capacity = 1.0;  ///< rho c, J/m^3/K
    double start = 0.0;          ///< m, x where the beam was switched on
    double x_low = -std::numeric_limits<double>::infinity(), x_high = -x_low; ///< m, walls
    double half_width = std::numeric_limits<double>::infinity();              ///< m, walls at y = +- this
    double depth = std::numeric_limits<double>::infinity();                   ///< m, wall at z = - this

    double beam(double elapsed) const { return start + speed * elapsed; }

    /// Rise in K at a point (m, x in the body's frame) `elapsed` s after the beam was switched on.
    double rise(const Vec3& p, double elapsed) const {
        return integral(p, std::sqrt(elapsed), [&](double s) { return beam(elapsed - s); });
    }

    /// rise() at all points of a grid of planes x, y and z (m), x fastest. The integrand is a product of one
    /// factor an axis, so the integral is a product of matrices.
    std::vector<double> rise_on(std::span<const double> x, std::span<const double> y,
                                std::span<const double> z, double elapsed) const {
        Eigen::MatrixXd along_x(x.size(), points_in_time), across_y(points_in_time, y.size()),
            down_z(points_in_time, z.size());
        const double dw = std::sqrt(elapsed) / points_in_time;
        for (int n = 0; n < points_in_time; ++n) {
            const double w = (n + 0.5) * dw, s = w * w, q = spread(s);
            for (std::size_t i = 0; i < x.size(); ++i)
                along_x(i, n) = factor() * dw * 4.0 / q * along(x[i], beam(elapsed - s), q);
            for (std::size_t j = 0; j < y.size(); ++j)
                across_y(n, j) = with_images(y[j], half_width, q);
            for (std::size_t k = 0; k < z.size(); ++k)
                down_z(n, k) = with_images(z[k], depth, 4.0 * diffusivity * s);
        }
        std::vector<double> rise(x.size() * y.size() * z.size());
        for (std::size_t k = 0; k < z.size(); ++k)
            Eigen::Map<Eigen::MatrixXd>(&rise[k * x.size() * y.size()], x.size(), y.size()).noalias() =
                along_x * (down_z.col(k).asDiagonal() * across_y);
        return rise;
    }

    /// Rise in K far from all walls, long after the start; x is counted from the beam.
    double steady_rise(const Vec3& p) const {
        const double longest = 80.0 * sigma * sigma / diffusivity + 60.0 * diffusivity / (speed * speed);
        EagarTsai open = *this;
        open.x_low = -std::numeric_limits<double>::infinity();
        open.x_high = open.half_width = open.depth = std::numeric_limits<double>::infinity();
        return open.integral(p, std::sqrt(longest), [&](double s) { return -speed * s; });
    }

  private:
    static constexpr int points_in_time = 2000;

    double factor() const {
        return absorbed_power /
               (std::numbers::pi * heat_capacity * std::sqrt(4.0 * std::numbers::pi * diffusivity));
    }

    double spread(double s) const { return 2.0 * (sigma * sigma + 2.0 * diffusivity * s); }

    double along(double p, double beam_x, double q) const {
        double sum = std::exp(-(p - beam_x) * (p - beam_x) / q);
        for (const double wall : {x_low, x_high})
            if (std::isfinite(wall))
                sum += std::exp(-(p - 2.0 * wall + beam_x) * (p - 2.0 * wall + beam_x) / q);
        return sum;
    }

    /// s = w^2 takes the root out of the integrand; the midpoint rule then converges fast.
    template <class BeamAt>
    double integral(const Vec3& p, double w_end, BeamAt beam_at) const {
        const double dw = w_end / points_in_time;
        double sum = 0.0;
        for (int i = 0; i < points_in_time; ++i) {
            const double w = (i + 0.5) * dw, s = w * w, q = spread(s);
            sum += 4.0 / q * along(p[0], beam_at(s), q) * with_images(p[1], half_width, q) *
                   with_images(p[2], depth, 4.0 * diffusivity * s);
        }
        return factor() * sum * dw;
    }

    /// exp(-r^2/q) and its images in walls at +- wall of a source on r = 0.
    static double with_images(double r, double wall, double q) {
        double sum = std::exp(-r * r / q);
        if (std::isfinite(wall))
            for (int n = 1; n <= 3; ++n)
                for (const double image : {r - 2.0 * n * wall, r + 2.0 * n * wall})
                    sum += std::exp(-image * image / q);
        return sum;
    }
};

} // namespace meltscope::verification
