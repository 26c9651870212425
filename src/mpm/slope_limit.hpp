#pragma once

#include "meltscope/mpm/boundary.hpp"
#include "meltscope/mpm/particles.hpp"
#include "meltscope/mpm/stencil.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace meltscope {

/// Cells down a slope within which it must not lead below the least energy. The B-spline coefficients
/// of a field that falls off as exp(-k x/dx) are positive for k < 2.06, so from half a cell on only what the
/// grid cannot resolve is touched; a little more leaves less undershoot where a laser comes on. One and a
/// half, which would be safe for each particle alone, costs accuracy at sudden steps; so would the same reach
/// along each axis at once, in a beam's tails, which fall off steeply in all directions.
inline constexpr double slope_reach = 0.6;

/// The least energy in J/kg for the lanes of a group; minus infinity for bins within one and a half cells of
/// a face that lets heat through: there the field goes on below the face's temperature, and rightly so.
inline Lanes least_energy_of_group(const Grid& grid, const Boundary& boundary, const LaneGroup& group,
                                   double least) {
    const auto lets_through = [&](int f) { return boundary[f].kind != FaceCondition::Kind::adiabatic; };
    const std::array<std::int64_t, 3> first{group.corner % grid.stride_y,
                                            group.corner % grid.stride_z / grid.stride_y,
                                            group.corner / grid.stride_z};
    const auto beside_face = [&](int axis, std::int64_t node) {
        return (lets_through(2 * axis) && node <= 1) ||
               (lets_through(2 * axis + 1) && node >= grid.cells[axis] - 1);
    };
    constexpr double none = -std::numeric_limits<double>::infinity();
    if (beside_face(1, first[1]) || beside_face(2, first[2]))
        return Lanes(none);
    Lanes result(least);
    for (int lane = 0; lane < lane_count; ++lane)
        if (beside_face(0, first[0] + lane))
            result[lane] = none;
    return result;
}

/// Shortens gradients (x, y, z, per cell) of particles of specific energies `energy` that would lead below
/// `least` within slope_reach. A limiter of the kind of X. Zhang, C.-W. Shu, J. Comput. Phys. 229 (2010)
/// 3091: where the field is resolved it does nothing.
template <int n>
void shorten_slopes(const Lanes& least, const double* energy, Gathered<n>& slope) {
    for (int p = 0; p < n * n * n; ++p) {
        const Lanes squared = slope_reach * slope_reach *
                              (slope.x[p] * slope.x[p] + slope.y[p] * slope.y[p] + slope.z[p] * slope.z[p]);
        const Lanes room = max(load(energy + p * lane_count) - least, Lanes(0.0));
        const auto too_steep = squared > room * room;
        if (none_of(too_steep))
            continue;
        const Lanes share =
            select(too_steep, room / sqrt(select(too_steep, squared, Lanes(1.0))), Lanes(1.0));
        slope.x[p] *= share;
        slope.y[p] *= share;
        slope.z[p] *= share;
    }
}

} // namespace meltscope
