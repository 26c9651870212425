#pragma once

#include "reference/eagar_tsai.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace meltscope::benchmarks {

/// A track on a plate of constant properties, with an exact solution: what time to solution is measured on.
/// The beam runs in the middle of the plate's top, z = 0; all faces are adiabatic. SI units.
struct Plate {
    static constexpr double density = 7570.0, heat_capacity = 600.0, conductivity = 22.0;
    static constexpr double absorbed_power = 59.1, d4sigma = 170e-6, speed = 0.8;
    static constexpr double length = 2.0e-3, width = 0.5e-3, depth = 0.25e-3, track = 1.5e-3;

    static constexpr double diffusivity = conductivity / (density * heat_capacity);
    static constexpr double start = 0.5 * (length - track);
    static constexpr double end_time = track / speed;
};

/// Whole cells of size dx, m, along each axis; a plate that is not a whole number of them deep is a little
/// deeper.
struct PlateCells {
    explicit PlateCells(double dx_)
        : dx(dx_), x(std::llround(Plate::length / dx)), y(std::llround(Plate::width / dx)),
          z(std::int64_t(std::ceil(Plate::depth / dx - 1e-6))) {}

    double dx;
    std::int64_t x, y, z;

    double depth() const { return double(z) * dx; } ///< m
};

inline verification::EagarTsai exact_solution(const PlateCells& cells) {
    verification::EagarTsai exact;
    exact.absorbed_power = Plate::absorbed_power;
    exact.sigma = 0.25 * Plate::d4sigma;
    exact.speed = Plate::speed;
    exact.diffusivity = Plate::diffusivity;
    exact.heat_capacity = Plate::density * Plate::heat_capacity;
    exact.start = Plate::start;
    exact.x_low = 0.0;
    exact.x_high = Plate::length;
    exact.half_width = 0.5 * Plate::width; // y is counted from the track
    exact.depth = cells.depth();
    return exact;
}

/// The exact rise in K at the end of the track at all nodes of the plate, x fastest; y from the side at
/// -width/2, z from the bottom.
class ExactRise {
  public:
    explicit ExactRise(const PlateCells& c)
        : nx(c.x + 1), ny(c.y + 1), nz(c.z + 1),
          rise_(exact_solution(c).rise_on(planes(nx, c.dx, 0.0), planes(ny, c.dx, -0.5 * Plate::width),
                                          planes(nz, c.dx, -c.depth()), Plate::end_time)),
          peak_(*std::max_element(rise_.begin(), rise_.end())) {}

    const std::int64_t nx, ny, nz; ///< nodes along each axis

    double peak() const { return peak_; }

    /// Largest difference at a node between `rise`(i, j, k) in K and the exact one, in % of the peak.
    template <class Rise>
    double error_percent(const Rise& rise) const {
        double most = 0.0;
        for (std::int64_t k = 0; k < nz; ++k)
            for (std::int64_t j = 0; j < ny; ++j)
                for (std::int64_t i = 0; i < nx; ++i)
                    most = std::max(most, std::abs(rise(i, j, k) - rise_[i + nx * (j + ny * k)]));
        return 100.0 * most / peak_;
    }

  private:
    static std::vector<double> planes(std::int64_t count, double dx, double first) {
        std::vector<double> place(count);
        for (std::int64_t i = 0; i < count; ++i)
            place[i] = first + double(i) * dx;
        return place;
    }

    std::vector<double> rise_;
    double peak_;
};

} // namespace meltscope::benchmarks
