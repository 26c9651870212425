#pragma once

#include "meltscope/aligned.hpp"
#include "meltscope/mpm/grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace meltscope {

/// Trilinear interpolation of a nodal field at a point (m); a point outside the box is moved to its face.
inline double trilinear(const Grid& grid, const Field& f, const Vec3& point) {
    std::array<std::int64_t, 3> cell;
    Vec3 r;
    for (int axis = 0; axis < 3; ++axis) {
        const double cells_in = (point[axis] - grid.origin[axis]) / grid.dx;
        cell[axis] = std::clamp(std::int64_t(std::floor(cells_in)), std::int64_t(0), grid.cells[axis] - 1);
        r[axis] = std::clamp(cells_in - double(cell[axis]), 0.0, 1.0);
    }
    const double* at = &f[grid.index(cell[0], cell[1], cell[2])];
    const auto along_x = [&](std::int64_t shift) { return at[shift] + r[0] * (at[shift + 1] - at[shift]); };
    const double low = along_x(0) + r[1] * (along_x(grid.stride_y) - along_x(0));
    const double high =
        along_x(grid.stride_z) + r[1] * (along_x(grid.stride_z + grid.stride_y) - along_x(grid.stride_z));
    return low + r[2] * (high - low);
}

} // namespace meltscope
