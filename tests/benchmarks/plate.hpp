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

inline verification::EagarTsai exact_solution() {
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
    exact.depth = Plate::depth;
    return exact;
}

/// The exact rise in K at the end of the track at all nodes of the plate, spacing dx, x fastest; y from the
/// side at -width/2, z from the bottom.
class ExactRise {
  public:
    explicit ExactRise(double dx)
        : nx(cells(Plate::length, dx) + 1), ny(cells(Plate::width, dx) + 1), nz(cells(Plate::depth, dx) + 1),
          rise_(exact_solution().rise_on(planes(nx, dx, 0.0), planes(ny, dx, -0.5 * Plate::width),
                                         planes(nz, dx, -Plate::depth), Plate::end_time)),
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

    static std::int64_t cells(double size, double dx) { return std::llround(size / dx); }

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
