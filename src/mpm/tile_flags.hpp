#pragma once

#include "meltscope/mpm/lane_layout.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace meltscope {

/// Calls work(first node, end, j, k) for the tiles of the box, threads sharing the planes along z. A tile:
/// the `lane_count` nodes of row (j,k), fewer at its end, that the bins of one lane group stand around.
template <class Work>
void for_each_tile(const Grid& grid, Work work) {
#pragma omp parallel for schedule(dynamic, 1)
    for (std::int64_t k = 0; k <= grid.cells[2]; ++k)
        for (std::int64_t j = 0; j <= grid.cells[1]; ++j)
            for (std::int64_t i = 0; i <= grid.cells[0]; i += lane_count)
                work(i, std::min<std::int64_t>(i + lane_count, grid.cells[0] + 1), j, k);
}

/// What is known of the nodes in each tile. With it whole groups are passed over where no surface is near.
class TileFlags {
  public:
    explicit TileFlags(const Grid& grid)
        : stride_y_(grid.stride_y / lane_count), stride_z_(grid.stride_z / lane_count),
          flags_(grid.size / lane_count, 0) {}

    std::int64_t count() const { return std::int64_t(flags_.size()); }
    unsigned char& operator[](std::int64_t tile) { return flags_[tile]; }
    unsigned char operator[](std::int64_t tile) const { return flags_[tile]; }

    /// The tile of node (i,j,k).
    std::int64_t tile_of(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return i / lane_count + j * stride_y_ + k * stride_z_;
    }

    /// The tile of a group, the storage index of whose corner is that of node (-1,-1,-1) of its first bin.
    static std::int64_t tile_of(const LaneGroup& group) { return group.corner / lane_count; }

    /// Sets the flags anew: work(first node, end, j, k) gives those of a tile.
    template <class Work>
    void set(const Grid& grid, Work work) {
        for_each_tile(grid, [&](std::int64_t first, std::int64_t end, std::int64_t j, std::int64_t k) {
            flags_[tile_of(first, j, k)] = work(first, end, j, k);
        });
    }

    /// Every tile takes on the flags of the 26 around it. What holds at none of these holds at no node that
    /// the particles of the tile reach.
    void widen() {
        for (const std::int64_t step : {std::int64_t(1), stride_y_, stride_z_})
            widen_along(step);
    }

  private:
    /// Along the axis of which tiles that are neighbours lie `step` apart. What runs over the end of a line
    /// ends in the tiles of ghosts, which have no flags to hand on.
    void widen_along(std::int64_t step) {
        const std::vector<unsigned char> before = flags_;
        // Seen from pointers to char the members might change with every flag.
        const unsigned char* const old = before.data();
        unsigned char* const flags = flags_.data();
        const std::int64_t size = count();
        for (std::int64_t at = 0; at < size - step; ++at)
            flags[at] |= old[at + step];
        for (std::int64_t at = 0; at < size - step; ++at)
            flags[at + step] |= old[at];
    }

    std::int64_t stride_y_, stride_z_; // of tiles, as they lie in the storage of a nodal field
    std::vector<unsigned char> flags_;
};

} // namespace meltscope
