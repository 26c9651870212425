#include "meltscope/mpm/grid.hpp"

#include <stdexcept>

namespace meltscope {

Grid make_grid(const Vec3& lower, double dx, const Index3& cells) {
    if (!(dx > 0.0) || (cells < 1).any())
        throw std::invalid_argument(
            "a grid needs a positive cell size and at least one cell along each axis");
    Grid grid;
    grid.origin = lower;
    grid.dx = dx;
    grid.cells = cells;
    // A lane group reads nodes -1 .. lane_count of its first bin; rows start on cache lines.
    const std::int64_t row = grid.groups_in_row() * lane_count + 2;
    grid.stride_y = (row + 7) / 8 * 8;
    grid.stride_z = grid.stride_y * (cells[1] + 3);
    grid.size = grid.stride_z * (cells[2] + 3);
    return grid;
}

} // namespace meltscope
