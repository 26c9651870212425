#include "meltscope/mpm/lane_layout.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace meltscope {
namespace {

/// Rows of bins in a block along y and along z. Two or more keep blocks of one colour apart; the value must
/// not depend on the number of threads, because it sets the order of the sums.
constexpr std::int64_t rows_in_block = 4;

/// A point this close below the border of two bins, in cells, counts to the upper one: lattice points on the
/// border then fall into one bin whatever their round-off.
constexpr double border_tolerance = 1e-9;

constexpr double lattice_tolerance = 1e-6; // cells

struct Row {
    std::int64_t j, k;
};

/// All rows of bins in the order of the blocks, and where each block starts.
struct RowOrder {
    std::vector<Row> rows;
    std::vector<std::int64_t> rank;        ///< of row (j,k): rank[j + k rows_y]
    std::vector<std::int64_t> block_start; ///< first row of each block, and the end
    std::array<std::int64_t, 5> colour_start{};
};

RowOrder order_rows(const Grid& grid) {
    RowOrder order;
    const std::int64_t rows_y = grid.cells[1] + 1, rows_z = grid.cells[2] + 1;
    order.rank.resize(rows_y * rows_z);
    for (int colour = 0; colour < 4; ++colour) {
        order.colour_start[colour] = std::int64_t(order.block_start.size());
        for (std::int64_t z = (colour / 2) * rows_in_block; z < rows_z; z += 2 * rows_in_block)
            for (std::int64_t y = (colour % 2) * rows_in_block; y < rows_y; y += 2 * rows_in_block) {
                order.block_start.push_back(std::int64_t(order.rows.size()));
                for (std::int64_t k = z; k < std::min(z + rows_in_block, rows_z); ++k)
                    for (std::int64_t j = y; j < std::min(y + rows_in_block, rows_y); ++j) {
                        order.rank[j + k * rows_y] = std::int64_t(order.rows.size());
                        order.rows.push_back({j, k});
                    }
            }
    }
    order.colour_start[4] = std::int64_t(order.block_start.size());
    order.block_start.push_back(std::int64_t(order.rows.size()));
    return order;
}

/// Index of the lattice point at `offset` in its bin, or -1 if it is none.
int lattice_index(const std::vector<double>& offsets, const std::array<double, 3>& offset) {
    const int n = int(offsets.size());
    int index = 0;
    for (int axis = 2; axis >= 0; --axis) {
        int nearest = -1;
        for (int a = 0; a < n; ++a)
            if (std::abs(offset[axis] - offsets[a]) < lattice_tolerance)
                nearest = a;
        if (nearest < 0)
            return -1;
        index = index * n + nearest;
    }
    return index;
}

/// The bin of a point; false if it lies outside the box.
bool find_bin(const Grid& grid, const Vec3& point, BinPlace& place) {
    for (int axis = 0; axis < 3; ++axis) {
        const double cells_in = (point[axis] - grid.origin[axis]) / grid.dx;
        const double nearest = std::floor(cells_in + 0.5 + border_tolerance);
        if (!(nearest >= 0.0 && nearest <= double(grid.cells[axis])))
            return false;
        place.node[axis] = std::int32_t(nearest);
        const double offset = cells_in - nearest;
        // On the border exactly, the third node's weight is exactly zero and it gets no mass from round-off.
        place.offset[axis] = std::abs(offset + 0.5) <= border_tolerance ? -0.5 : offset;
    }
    return true;
}

/// One bin's points of one kind.
struct BinFill {
    std::int32_t count = 0;
    bool off_lattice = false;
};

} // namespace

std::vector<double> lattice_offsets(int n) {
    std::vector<double> offsets(n);
    for (int a = 0; a < n; ++a) {
        const double fraction = (a + 0.5) / n; // of the cell; from 1/2 on the next node is the nearest
        offsets[a] = fraction < 0.5 - border_tolerance ? fraction : fraction - 1.0;
    }
    std::sort(offsets.begin(), offsets.end());
    return offsets;
}

BinPlace bin_place(const Grid& grid, const Vec3& point) {
    BinPlace place;
    if (!find_bin(grid, point, place))
        throw std::out_of_range(
            fmt::format("the point ({}, {}, {}) m lies outside the domain", point[0], point[1], point[2]));
    return place;
}

LaneLayout make_lane_layout(const Grid& grid, std::span<const Vec3> points,
                            std::span<const std::int16_t> kind, int lattice) {
    const std::int64_t count = std::int64_t(points.size());
    const std::int64_t groups_x = grid.groups_in_row(), rows_y = grid.cells[1] + 1;
    const RowOrder order = order_rows(grid);
    const int kinds = kind.empty() ? 1 : 1 + *std::max_element(kind.begin(), kind.end());
    const std::vector<double> offsets = lattice > 0 ? lattice_offsets(lattice) : std::vector<double>{};
    const std::int32_t lattice_points = lattice * lattice * lattice;

    std::vector<std::int64_t> bin_of(count);
    std::vector<std::int32_t> rank_in_bin(count), lattice_slot(lattice > 0 ? count : 0);
    bool outside = false; // an exception must not leave a parallel region
#pragma omp parallel for schedule(static) reduction(|| : outside)
    for (std::int64_t p = 0; p < count; ++p) {
        BinPlace place;
        if (!find_bin(grid, points[p], place)) {
            outside = true;
            continue;
        }
        const std::int64_t row = order.rank[place.node[1] + place.node[2] * rows_y];
        const std::int64_t group =
            (row * groups_x + place.node[0] / lane_count) * kinds + (kind.empty() ? 0 : kind[p]);
        bin_of[p] = group * lane_count + place.node[0] % lane_count;
        if (lattice > 0)
            lattice_slot[p] = lattice_index(offsets, place.offset);
    }
    if (outside)
        for (const Vec3& point : points)
            bin_place(grid, point); // says which

    // Fill of every bin, in the order in which groups are laid out: row, group in the row, kind, lane.
    std::vector<BinFill> fill(order.rows.size() * groups_x * kinds * lane_count);
    for (std::int64_t p = 0; p < count; ++p) {
        BinFill& bin = fill[bin_of[p]];
        rank_in_bin[p] = bin.count++;
        bin.off_lattice |= lattice > 0 && lattice_slot[p] < 0;
    }

    LaneLayout layout;
    std::vector<std::int64_t> group_at(order.rows.size() * groups_x * kinds, -1);
    for (std::size_t block = 0; block + 1 < order.block_start.size(); ++block) {
        LaneBlock range{std::int64_t(layout.groups.size()), 0};
        for (std::int64_t row = order.block_start[block]; row < order.block_start[block + 1]; ++row)
            for (std::int64_t gx = 0; gx < groups_x; ++gx)
                for (int m = 0; m < kinds; ++m) {
                    const std::int64_t at = (row * groups_x + gx) * kinds + m;
                    const BinFill* bins = &fill[at * lane_count];
                    std::int32_t most = 0;
                    bool on_lattice = lattice > 0;
                    for (int lane = 0; lane < lane_count; ++lane) {
                        most = std::max(most, bins[lane].count);
                        on_lattice =
                            on_lattice && !bins[lane].off_lattice && bins[lane].count <= lattice_points;
                    }
                    if (most == 0)
                        continue;
                    // A lattice group costs about what half its points cost one by one.
                    on_lattice = on_lattice && 2 * most >= lattice_points;
                    LaneGroup group;
                    group.corner =
                        grid.index(gx * lane_count - 1, order.rows[row].j - 1, order.rows[row].k - 1);
                    group.first_slot = layout.slots;
                    group.first_loose = layout.loose_slots;
                    group.slots = on_lattice ? lattice_points : most;
                    group.kind = std::int16_t(m);
                    group.on_lattice = on_lattice;
                    group_at[at] = std::int64_t(layout.groups.size());
                    layout.groups.push_back(group);
                    layout.slots += group.slots;
                    layout.loose_slots += on_lattice ? 0 : group.slots;
                }
        range.last_group = std::int64_t(layout.groups.size());
        layout.blocks.push_back(range);
    }
    layout.colour_start = order.colour_start;

    layout.place.resize(count);
#pragma omp parallel for schedule(static)
    for (std::int64_t p = 0; p < count; ++p) {
        const LaneGroup& group = layout.groups[group_at[bin_of[p] / lane_count]];
        const std::int64_t slot = group.on_lattice ? lattice_slot[p] : rank_in_bin[p];
        layout.place[p] = (group.first_slot + slot) * lane_count + bin_of[p] % lane_count;
    }
    return layout;
}

GroupRuns all_groups(const LaneLayout& layout) {
    GroupRuns all;
    for (int colour = 0; colour < 4; ++colour) {
        all.colour_start[colour] = std::int64_t(all.runs.size());
        for (std::int64_t b = layout.colour_start[colour]; b < layout.colour_start[colour + 1]; ++b)
            if (layout.blocks[b].first_group < layout.blocks[b].last_group)
                all.runs.push_back(layout.blocks[b]);
    }
    all.colour_start[4] = std::int64_t(all.runs.size());
    for (std::size_t run = 0; run <= all.runs.size(); ++run)
        all.block_start.push_back(std::int64_t(run)); // one a block
    return all;
}

} // namespace meltscope
