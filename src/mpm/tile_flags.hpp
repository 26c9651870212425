#pragma once

#include "meltscope/mpm/lane_layout.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace meltscope {

/// What is known of the nodes in each tile: the `lane_count` nodes that the bins of one lane group stand
/// around. With it whole groups are passed over where no surface is near.
class TileFlags {
  public:
    explicit TileFlags(const Grid& grid)
        : tiles_x_(grid.groups_in_row()), rows_y_(grid.cells[1] + 1), rows_z_(grid.cells[2] + 1),
          stride_y_(grid.stride_y), stride_z_(grid.stride_z), flags_(tiles_x_ * rows_y_ * rows_z_, 0) {}

    std::int64_t count() const { return std::int64_t(flags_.size()); }
    unsigned char& operator[](std::int64_t tile) { return flags_[tile]; }
    unsigned char operator[](std::int64_t tile) const { return flags_[tile]; }

    std::int64_t tile_of(std::int64_t i, std::int64_t j, std::int64_t k) const {
        return i / lane_count + tiles_x_ * (j + rows_y_ * k);
    }

    /// The tile of a group, which its corner tells: node (-1,-1,-1) of its first bin.
    std::int64_t tile_of(const LaneGroup& group) const {
        return group.corner % stride_y_ / lane_count +
               tiles_x_ * (group.corner % stride_z_ / stride_y_ + rows_y_ * (group.corner / stride_z_));
    }

    /// Sets the flags anew: work(first node, end, j, k) gives those of a tile, threads sharing the planes.
    template <class Work>
    void set(const Grid& grid, Work work) {
#pragma omp parallel for schedule(static)
        for (std::int64_t k = 0; k < rows_z_; ++k)
            for (std::int64_t j = 0; j < rows_y_; ++j)
                for (std::int64_t i = 0; i <= grid.cells[0]; i += lane_count)
                    flags_[tile_of(i, j, k)] =
                        work(i, std::min<std::int64_t>(i + lane_count, grid.cells[0] + 1), j, k);
    }

    /// Every tile takes on the flags of the 26 around it. What holds at none of these holds at no node that
    /// the particles of the tile reach.
    void widen() {
        widen_along(1, tiles_x_);
        widen_along(tiles_x_, rows_y_);
        widen_along(tiles_x_ * rows_y_, rows_z_);
    }

  private:
    /// Along the axis of which tiles that are neighbours lie `step` apart, `length` in a line.
    void widen_along(std::int64_t step, std::int64_t length) {
        const std::vector<unsigned char> before = flags_;
        for (std::int64_t lines = 0; lines < count(); lines += step * length)
            for (std::int64_t at = lines; at < lines + step * (length - 1); ++at) {
                flags_[at] |= before[at + step];
                flags_[at + step] |= before[at];
            }
    }

    std::int64_t tiles_x_, rows_y_, rows_z_, stride_y_, stride_z_;
    std::vector<unsigned char> flags_;
};

} // namespace meltscope
