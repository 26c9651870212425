#pragma once

#include "reference/driver.hpp"

#include <algorithm>
#include <string>

namespace meltscope::verification {

/// A body that is known by its exact signed distance, negative inside, in cells (dx = 1).
struct ExactShape {
    std::string name;
    Index3 cells; ///< of the box it is set into
    std::function<double(const Vec3&)> distance;
    double area = 0.0;                                    ///< in the box; zero where it is not used
    std::function<bool(const Vec3&)> counts = everywhere; ///< where it may be compared
    std::function<double(const Vec3&)> window = [](const Vec3&) { return 1.0; }; ///< of the area
};

/// Weight that falls smoothly to zero towards the walls that a tilted plane meets at an angle: its mirror
/// image there makes an edge. Integrates over a plane to 12 x 6 / cos(tilt).
inline double plane_window(const Vec3& x) {
    return std::abs(x[0] - 16.0) < 12.0 ? 0.5 + 0.5 * std::cos(M_PI * (x[0] - 16.0) / 12.0) : 0.0;
}

/// Off the lattice on purpose, so that nothing lines up.
inline const Vec3& odd_shift() {
    static const Vec3 shift(0.31, -0.17, 0.23);
    return shift;
}

inline ExactShape sphere(double radius) {
    const int n = 2 * int(std::ceil(radius)) + 10;
    const Vec3 centre = Vec3::Constant(0.5 * n) + odd_shift();
    return {"sphere R = " + std::to_string(int(radius)) + " dx", Index3::Constant(n),
            [=](const Vec3& x) { return (x - centre).norm() - radius; }, 4.0 * M_PI * radius * radius};
}

/// A plate whose upper face is tilted about y by `degrees`; walls on all sides.
inline ExactShape plane(double degrees, double shift = 0.0) {
    const Index3 cells(32, 6, 32);
    const double angle = degrees * M_PI / 180.0;
    const Vec3 normal(-std::sin(angle), 0.0, std::cos(angle));
    const Vec3 point(16.0, 3.0, 16.0 + shift);
    return {"plane " + std::to_string(int(degrees)) + " degrees", cells,
            [=](const Vec3& x) { return (x - point).dot(normal); }, 12.0 / std::cos(angle) * 6.0,
            // where the face meets a wall, its mirror image meets it at an angle
            [=](const Vec3& x) { return degrees == 0.0 || (x[0] > 4.0 && x[0] < 28.0); }, plane_window};
}

inline ExactShape torus(double large, double small) {
    const int n = 2 * int(std::ceil(large + small)) + 8;
    const Vec3 centre = Vec3::Constant(0.5 * n) + odd_shift();
    return {"torus", Index3(n, n, 2 * int(std::ceil(small)) + 8),
            [=](const Vec3& x) {
                const Vec3 r =
                    x - Vec3(centre[0], centre[1], 0.5 * (2.0 * std::ceil(small) + 8.0) + odd_shift()[2]);
                return std::hypot(std::hypot(r[0], r[1]) - large, r[2]) - small;
            },
            4.0 * M_PI * M_PI * large * small};
}

/// Compared where both spheres are further than three quarters of a radius from the contact.
inline ExactShape touching_spheres(double radius) {
    const int n = 2 * int(std::ceil(radius)) + 8;
    const Vec3 middle = Vec3(double(n), 0.5 * n, 0.5 * n) + odd_shift();
    const Vec3 axis = Vec3(1.0, 0.3, 0.2).normalized();
    return {"touching spheres R = " + std::to_string(int(radius)) + " dx", Index3(2 * n, n + 8, n + 8),
            [=](const Vec3& x) {
                const Vec3 r = x - middle - Vec3(0.0, 4.0, 4.0);
                return std::min((r - radius * axis).norm(), (r + radius * axis).norm()) - radius;
            },
            8.0 * M_PI * radius * radius,
            [=](const Vec3& x) { return (x - middle - Vec3(0.0, 4.0, 4.0)).norm() > 0.75 * radius; }};
}

/// The shape as particles on a grid of spacing dx = 1.
struct SampledShape {
    Grid grid;
    Particles particles;
};

/// `n` points a cell along each axis; jittered ones are moved by up to a quarter of their spacing.
inline SampledShape sample_shape(const ExactShape& shape, int n, bool jittered) {
    SampledShape sampled{make_grid(Vec3::Zero(), 1.0, shape.cells), {}};
    ParticleList list =
        lattice_points(sampled.grid, n, [&](const Vec3& x) { return shape.distance(x) < 0.0; });
    if (jittered)
        jitter(sampled.grid, 0.25 / n, list);
    list.mass = list.volume;
    sampled.particles = make_particles(sampled.grid, std::move(list), jittered ? 0 : n);
    return sampled;
}

/// Errors of phi at nodes within two cells of the surface, in cells.
struct DistanceError {
    double most = 0.0;
    double rms = 0.0;
    double gradient = 0.0; ///< largest ||grad phi| - 1|, central differences, nodes off the box's faces
    double gradient_rms = 0.0;
};

inline DistanceError distance_error(const ExactShape& shape, const Grid& grid, const Field& phi) {
    DistanceError error;
    double count = 0.0, gradient_count = 0.0;
    for (std::int64_t k = 1; k < grid.cells[2]; ++k)
        for (std::int64_t j = 1; j < grid.cells[1]; ++j)
            for (std::int64_t i = 1; i < grid.cells[0]; ++i) {
                const Vec3 x = grid.position(i, j, k);
                const double exact = shape.distance(x);
                if (std::abs(exact) > 2.0 || !shape.counts(x))
                    continue;
                const std::int64_t at = grid.index(i, j, k);
                error.most = std::max(error.most, std::abs(phi[at] - exact));
                error.rms += (phi[at] - exact) * (phi[at] - exact);
                count += 1.0;
                // where two parts of the surface are equally near, the exact distance has a kink too
                const auto central = [](auto value) -> Vec3 {
                    return 0.5 * Vec3(value(Vec3::UnitX()) - value(-Vec3::UnitX()),
                                      value(Vec3::UnitY()) - value(-Vec3::UnitY()),
                                      value(Vec3::UnitZ()) - value(-Vec3::UnitZ()));
                };
                if (central([&](const Vec3& d) { return shape.distance(x + d); }).norm() < 0.98)
                    continue;
                const Vec3 gradient = central([&](const Vec3& d) {
                    return phi[at + std::int64_t(d[0]) + std::int64_t(d[1]) * grid.stride_y +
                               std::int64_t(d[2]) * grid.stride_z];
                });
                const double off = std::abs(gradient.norm() - 1.0);
                error.gradient = std::max(error.gradient, off);
                error.gradient_rms += off * off;
                gradient_count += 1.0;
            }
    error.rms = std::sqrt(error.rms / count);
    error.gradient_rms = std::sqrt(error.gradient_rms / gradient_count);
    return error;
}

} // namespace meltscope::verification
