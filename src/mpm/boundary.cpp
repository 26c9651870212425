#include "meltscope/mpm/boundary.hpp"

#include <algorithm>

namespace meltscope {

namespace {

/// Whether threads that share the nodes of all faces gain more than it takes to call them.
bool has_many_face_nodes(const Grid& grid) {
    const Index3 planes = grid.cells + 3;
    return 2 * (planes[0] * planes[1] + planes[1] * planes[2] + planes[2] * planes[0]) > 10000;
}

} // namespace

FacePlanes face_planes(const Grid& grid, int f) {
    const int axis = f / 2;
    // Storage coordinates start at the lower ghost plane.
    if (f % 2 == 0)
        return {axis, 0, 1, 2};
    const std::int64_t last = grid.cells[axis] + 1;
    return {axis, last + 1, last, last - 1};
}

void fold_ghosts(const Grid& grid, const Boundary& boundary, AtFixedFaces at_fixed, Field& field) {
    // Axis after axis, ghosts of the later axes included, so that edges and corners reach their mirror nodes.
#pragma omp parallel if (has_many_face_nodes(grid))
    for (int f = 0; f < 6; ++f) {
        if (boundary[f].fixes_temperature()) {
            if (at_fixed == AtFixedFaces::leave)
                continue;
            const double sign = at_fixed == AtFixedFaces::odd ? -1.0 : 1.0;
            for_each_face_node(grid, f, [&](std::int64_t ghost, std::int64_t, std::int64_t mirror) {
                field[mirror] += sign * field[ghost];
                field[ghost] = 0.0;
            });
        } else {
            for_each_face_node(grid, f, [&](std::int64_t ghost, std::int64_t, std::int64_t mirror) {
                field[mirror] += field[ghost];
                field[ghost] = 0.0;
            });
        }
    }
}

void mirror_ghosts(const Grid& grid, const Boundary& boundary, Field& field) {
#pragma omp parallel if (has_many_face_nodes(grid))
    for (int f = 0; f < 6; ++f)
        if (!boundary[f].fixes_temperature())
            for_each_face_node(grid, f, [&](std::int64_t ghost, std::int64_t, std::int64_t mirror) {
                field[ghost] = field[mirror];
            });
}

std::vector<std::int64_t> nodes_near_fixed_faces(const Grid& grid, const Boundary& boundary) {
    std::vector<std::int64_t> nodes;
    for (int f = 0; f < 6; ++f) {
        if (!boundary[f].fixes_temperature())
            continue;
        const FacePlanes planes = face_planes(grid, f);
        const std::array<std::int64_t, 3> stride{1, grid.stride_y, grid.stride_z};
        const int u = planes.axis == 0 ? 1 : 0, v = planes.axis == 2 ? 1 : 2;
        for (const std::int64_t plane : {planes.ghost, planes.face, planes.mirror})
            for (std::int64_t q = 0; q < grid.cells[v] + 3; ++q)
                for (std::int64_t p = 0; p < grid.cells[u] + 3; ++p)
                    nodes.push_back(plane * stride[planes.axis] + p * stride[u] + q * stride[v]);
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

} // namespace meltscope
