#include "level_set_rays.hpp"

#include "meltscope/mpm/trilinear.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope {
namespace {

/// The stretch of the ray that lies in the box, as distances from its start; empty if first > last.
struct Stretch {
    double first, last;
};

Stretch clip(const Grid& grid, const Vec3& start, const Vec3& direction) {
    Stretch s{0.0, std::numeric_limits<double>::infinity()};
    const Vec3 low = grid.origin, high = grid.upper_corner();
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(direction[axis]) < 1e-12) {
            if (start[axis] < low[axis] || start[axis] > high[axis])
                return {1.0, 0.0};
            continue;
        }
        const double a = (low[axis] - start[axis]) / direction[axis];
        const double b = (high[axis] - start[axis]) / direction[axis];
        s.first = std::max(s.first, std::min(a, b));
        s.last = std::min(s.last, std::max(a, b));
    }
    return s;
}

} // namespace

double first_interface(const Grid& grid, const Field& phi, const Vec3& start, const Vec3& direction) {
    const Stretch s = clip(grid, start, direction);
    const double shortest = 0.1 * grid.dx;
    double t = s.first, before = s.first, phi_before = 0.0;
    while (t <= s.last) {
        const double value = trilinear(grid, phi, start + t * direction);
        if (value <= 0.0) {
            const double fall = phi_before - value;
            return fall > 0.0 ? before + (t - before) * phi_before / fall : t;
        }
        before = t;
        phi_before = value;
        t += std::max(shortest, 0.9 * value);
    }
    return std::numeric_limits<double>::infinity();
}

} // namespace meltscope
