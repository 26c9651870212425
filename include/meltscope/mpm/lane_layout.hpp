#pragma once

#include "meltscope/mpm/grid.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace meltscope {

/// `lane_count` bins that are neighbours in x. Slot s holds the s-th point of each bin, lane = bin; slots
/// that a bin does not fill are padding. All points of a group have one kind (for particles: the material).
struct LaneGroup {
    std::int64_t corner = 0; ///< storage index of node (-1,-1,-1) of lane 0's bin
    std::int64_t first_slot = 0;
    std::int64_t first_loose = 0; ///< of a group that is not on the lattice: its first slot among those
    std::int32_t slots = 0;
    std::int16_t kind = 0;
    bool on_lattice = false; ///< slot s is the lattice point s of the bin, the same in every lane
};

/// A range of groups that one thread works on: a few neighbouring rows in y and z.
struct LaneBlock {
    std::int64_t first_group = 0, last_group = 0;
};

/// Where each point sits in a layout of lane groups.
///
/// A bin is the box of side dx around a node, so all points of a bin share the same 27 nodes. Blocks of one
/// colour have no node in common; blocks are visited colour by colour, so every node receives its sums in an
/// order that does not depend on the number of threads.
struct LaneLayout {
    std::vector<LaneGroup> groups;
    std::vector<LaneBlock> blocks; ///< sorted by colour
    std::array<std::int64_t, 5>
        colour_start{};              ///< blocks of colour c are colour_start[c] .. colour_start[c+1]
    std::vector<std::int64_t> place; ///< of each point: slot * lane_count + lane
    std::int64_t slots = 0;
    std::int64_t loose_slots = 0; ///< of the groups that are not on the lattice

    std::int64_t size() const { return slots * lane_count; } ///< entries of a per-point array in this layout
};

/// Some of the groups of a layout, in its order.
struct GroupRuns {
    std::vector<LaneBlock> runs;              ///< groups that follow on each other in a block
    std::vector<std::int64_t> block_start;    ///< first run of each block that has any, and the end
    std::array<std::int64_t, 5> colour_start; ///< first block of each colour, and the end
};

/// All groups.
GroupRuns all_groups(const LaneLayout& layout);

/// Where a point lies in its bin.
struct BinPlace {
    std::array<std::int32_t, 3> node; ///< nearest node
    std::array<double, 3> offset;     ///< from it, in cells, in [-1/2, 1/2)
};

/// The bin of a point inside the box; points on the box's faces belong to the bins of the face's nodes.
BinPlace bin_place(const Grid& grid, const Vec3& point);

/// Lays the points out. `kind` is empty (all 0) or one entry a point. With `lattice` = n > 0, groups of which
/// every point is on the lattice of n x n x n points a cell (cell fractions (a + 1/2)/n) are laid out as
/// lattice groups. Throws std::out_of_range if a point lies outside the box.
LaneLayout make_lane_layout(const Grid& grid, std::span<const Vec3> points,
                            std::span<const std::int16_t> kind, int lattice);

/// Offsets from the nearest node, in cells, of the n lattice points in a bin along one axis, ascending.
std::vector<double> lattice_offsets(int n);

/// Calls `work(block)` for every block, colour after colour, threads sharing the blocks of a colour.
template <class Work>
void for_each_block(const LaneLayout& layout, Work work) {
#pragma omp parallel
    for (int colour = 0; colour < 4; ++colour) {
#pragma omp for schedule(dynamic, 1)
        for (std::int64_t b = layout.colour_start[colour]; b < layout.colour_start[colour + 1]; ++b)
            work(layout.blocks[b]);
    }
}

/// The same for some of the groups: calls `work(run)` for every run.
template <class Work>
void for_each_block(const GroupRuns& groups, Work work) {
#pragma omp parallel
    for (int colour = 0; colour < 4; ++colour) {
#pragma omp for schedule(dynamic, 1)
        for (std::int64_t b = groups.colour_start[colour]; b < groups.colour_start[colour + 1]; ++b)
            for (std::int64_t r = groups.block_start[b]; r < groups.block_start[b + 1]; ++r)
                work(groups.runs[r]);
    }
}

} // namespace meltscope
