#pragma once

#include "meltscope/lanes.hpp"
#include "meltscope/vec3.hpp"

#include <cstdint>

namespace meltscope {

/// A uniform grid of nodes over a box, with one layer of ghost nodes outside each face.
///
/// Node (i,j,k), 0 <= i <= cells, is at origin + dx (i,j,k); the box's faces are planes of nodes. Storage is
/// x fastest, rows padded so that a lane group may load `lane_count` nodes from any bin of the row (see
/// LaneLayout).
struct Grid {
    Vec3 origin = Vec3::Zero(); ///< m, the box's lower corner
    double dx = 0.0;            ///< m
    Index3 cells = Index3::Zero();
    std::int64_t stride_y = 0; ///< storage distance of neighbours in y
    std::int64_t stride_z = 0; ///< storage distance of neighbours in z
    std::int64_t size = 0;     ///< doubles in a nodal field

    /// Storage index of node (i,j,k), -1 <= i <= cells + 1.
    std::int64_t index(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return (k + 1) * stride_z + (j + 1) * stride_y + (i + 1);
    }

    /// Place of node (i,j,k) in m.
    Vec3 position(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return origin + dx * Vec3(double(i), double(j), double(k));
    }

    Vec3 upper_corner() const { return position(cells[0], cells[1], cells[2]); }

    /// Lane groups in a row: every bin i = 0 .. cells[0] belongs to one.
    std::int64_t groups_in_row() const { return (cells[0] + lane_count) / lane_count; }

    /// Nodes of the box, ghosts not counted.
    std::int64_t node_count() const { return (cells + 1).prod(); }

    /// Share of a node's dx^3 that lies in the box: halved for each face the node is on.
    double share_in_box(std::int64_t i, std::int64_t j, std::int64_t k) const {
        const auto half_on_face = [](std::int64_t n, std::int64_t last) {
            return n == 0 || n == last ? 0.5 : 1.0;
        };
        return half_on_face(i, cells[0]) * half_on_face(j, cells[1]) * half_on_face(k, cells[2]);
    }
};

/// The grid over [lower, lower + dx cells]. Throws std::invalid_argument if dx <= 0 or a count is below one.
Grid make_grid(const Vec3& lower, double dx, const Index3& cells);

} // namespace meltscope
