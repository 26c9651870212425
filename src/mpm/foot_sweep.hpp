#pragma once

#include "meltscope/aligned.hpp"
#include "meltscope/mpm/grid.hpp"

#include <algorithm>
#include <vector>

namespace meltscope {

/// The point of the free surface that is nearest to a node next to it.
struct Foot {
    Vec3 point;  ///< m, on the surface
    Vec3 normal; ///< unit, out of the material
};

/// Of each row of nodes along x, the stretch in which a foot may be the nearest; elsewhere there is none.
struct NodeBand {
    struct Stretch {
        std::int64_t first = 0, last = -1; ///< nodes along x, both inclusive; empty where last < first
    };
    std::int64_t rows_y = 0;
    std::vector<Stretch> stretch; ///< of row (j,k): stretch[j + k rows_y]

    const Stretch& of_row(std::int64_t j, std::int64_t k) const { return stretch[j + k * rows_y]; }

    /// Whether any node (i,j,k) belongs to it.
    bool reaches_plane(std::int64_t k) const {
        if (k < 0 || (k + 1) * rows_y > std::int64_t(stretch.size()))
            return false;
        return std::any_of(&stretch[k * rows_y], &stretch[k * rows_y] + rows_y,
                           [](const Stretch& row) { return row.first <= row.last; });
    }

    /// Calls work(i, j, k, storage index) for every node of the band, threads sharing the planes along z.
    template <class Work>
    void for_each_node(const Grid& grid, Work work) const {
#pragma omp parallel for schedule(dynamic, 1)
        for (std::int64_t k = 0; k <= grid.cells[2]; ++k)
            for (std::int64_t j = 0; j <= grid.cells[1]; ++j) {
                const Stretch& row = of_row(j, k);
                for (std::int64_t i = row.first; i <= row.last; ++i)
                    work(i, j, k, grid.index(i, j, k));
            }
    }
};

/// The nodes within `reach` cells along each axis of those that have a foot (nearest >= 0).
NodeBand band_around(const Grid& grid, const std::vector<std::int32_t>& nearest, std::int64_t reach);

/// Finds the foot nearest to each node within `reach` (m): hands feet from node to node along each axis,
/// there and back, twice over, and at last from all 26 neighbours. `nearest` holds indices into `feet`, -1
/// for none; at first each foot is known to one node only, less than a cell away.
NodeBand sweep_feet(const Grid& grid, const std::vector<Foot>& feet, double reach,
                    std::vector<std::int32_t>& nearest);

} // namespace meltscope
