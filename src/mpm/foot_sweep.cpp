#include "foot_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace meltscope {
namespace {

using Stretch = NodeBand::Stretch;

/// The smallest stretch that holds both.
Stretch hull(const Stretch& a, const Stretch& b) {
    if (a.last < a.first)
        return b;
    if (b.last < b.first)
        return a;
    return {std::min(a.first, b.first), std::max(a.last, b.last)};
}

/// Every entry of a line of `count` stretches, `step` apart, becomes the hull of those within `reach`.
void widen_line(Stretch* line, std::int64_t count, std::int64_t step, std::int64_t reach,
                std::vector<Stretch>& before) {
    before.resize(count);
    for (std::int64_t n = 0; n < count; ++n)
        before[n] = line[n * step];
    for (std::int64_t n = 0; n < count; ++n)
        for (std::int64_t m = std::max<std::int64_t>(0, n - reach); m <= std::min(count - 1, n + reach); ++m)
            line[n * step] = hull(line[n * step], before[m]);
}

class Sweep {
  public:
    Sweep(const Grid& grid, const NodeBand& band, const std::vector<Foot>& feet, double reach,
          std::vector<std::int32_t>& nearest)
        : grid_(grid), band_(band), feet_(feet), nearest_(nearest),
          squared_(std::make_unique_for_overwrite<double[]>(grid.size)) {
        band_.for_each_node(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at) {
            squared_[at] = nearest_[at] < 0
                               ? reach * reach
                               : (grid.position(i, j, k) - feet_[nearest_[at]].point).squaredNorm();
        });
    }

    void along_x() {
#pragma omp parallel for schedule(dynamic, 1)
        for (std::int64_t k = 0; k <= grid_.cells[2]; ++k)
            for (std::int64_t j = 0; j <= grid_.cells[1]; ++j) {
                const Stretch& row = band_.of_row(j, k);
                for (std::int64_t i = row.first + 1; i <= row.last; ++i)
                    offer(i, j, k, grid_.index(i, j, k), -1);
                for (std::int64_t i = row.last - 1; i >= row.first; --i)
                    offer(i, j, k, grid_.index(i, j, k), 1);
            }
    }

    void along_y() {
#pragma omp parallel for schedule(dynamic, 1)
        for (std::int64_t k = 0; k <= grid_.cells[2]; ++k) {
            for (std::int64_t j = 1; j <= grid_.cells[1]; ++j)
                offer_to_row(j, k, -grid_.stride_y);
            for (std::int64_t j = grid_.cells[1] - 1; j >= 0; --j)
                offer_to_row(j, k, grid_.stride_y);
        }
    }

    void along_z() {
#pragma omp parallel for schedule(dynamic, 1)
        for (std::int64_t j = 0; j <= grid_.cells[1]; ++j) {
            for (std::int64_t k = 1; k <= grid_.cells[2]; ++k)
                offer_to_row(j, k, -grid_.stride_z);
            for (std::int64_t k = grid_.cells[2] - 1; k >= 0; --k)
                offer_to_row(j, k, grid_.stride_z);
        }
    }

    /// Every node looks at the feet of its 26 neighbours: what a row hands on along an axis can stop short of
    /// a node whose own foot lies askew.
    void all_around() {
        const std::vector<std::int32_t> before = nearest_;
        band_.for_each_node(grid_, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at) {
            for (std::int64_t c = std::max<std::int64_t>(k - 1, 0); c <= std::min(k + 1, grid_.cells[2]); ++c)
                for (std::int64_t b = std::max<std::int64_t>(j - 1, 0); b <= std::min(j + 1, grid_.cells[1]);
                     ++b)
                    for (std::int64_t a = std::max<std::int64_t>(i - 1, 0);
                         a <= std::min(i + 1, grid_.cells[0]); ++a)
                        take(i, j, k, at, before[grid_.index(a, b, c)]);
        });
    }

  private:
    void offer_to_row(std::int64_t j, std::int64_t k, std::int64_t from) {
        const Stretch& row = band_.of_row(j, k);
        for (std::int64_t i = row.first; i <= row.last; ++i)
            offer(i, j, k, grid_.index(i, j, k), from);
    }

    void offer(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at, std::int64_t from) {
        take(i, j, k, at, nearest_[at + from]);
    }

    void take(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at, std::int32_t foot) {
        if (foot < 0 || foot == nearest_[at])
            return;
        const double squared = (grid_.position(i, j, k) - feet_[foot].point).squaredNorm();
        if (squared < squared_[at]) {
            squared_[at] = squared;
            nearest_[at] = foot;
        }
    }

    const Grid& grid_;
    const NodeBand& band_;
    const std::vector<Foot>& feet_;
    std::vector<std::int32_t>& nearest_;
    std::unique_ptr<double[]> squared_; // m^2, of the band's nodes only
};

} // namespace

NodeBand band_around(const Grid& grid, const std::vector<std::int32_t>& nearest, std::int64_t reach) {
    const std::int64_t rows_y = grid.cells[1] + 1, rows_z = grid.cells[2] + 1;
    NodeBand band{rows_y, std::vector<Stretch>(rows_y * rows_z)};
#pragma omp parallel for schedule(static)
    for (std::int64_t row = 0; row < rows_y * rows_z; ++row) {
        const std::int32_t* at = &nearest[grid.index(0, row % rows_y, row / rows_y)];
        const auto has_foot = [](std::int32_t foot) { return foot >= 0; };
        const std::int64_t first = std::find_if(at, at + grid.cells[0] + 1, has_foot) - at;
        if (first > grid.cells[0])
            continue;
        std::int64_t last = grid.cells[0];
        while (at[last] < 0)
            --last;
        band.stretch[row] = {std::max<std::int64_t>(0, first - reach), std::min(grid.cells[0], last + reach)};
    }
    std::vector<Stretch> before;
    for (std::int64_t k = 0; k < rows_z; ++k)
        widen_line(&band.stretch[k * rows_y], rows_y, 1, reach, before);
    for (std::int64_t j = 0; j < rows_y; ++j)
        widen_line(&band.stretch[j], rows_z, rows_y, reach, before);
    return band;
}

NodeBand sweep_feet(const Grid& grid, const std::vector<Foot>& feet, double reach,
                    std::vector<std::int32_t>& nearest) {
    NodeBand band = band_around(grid, nearest, std::int64_t(std::floor(reach / grid.dx + 1.0)));
    Sweep sweep(grid, band, feet, reach, nearest);
    for (int round = 0; round < 2; ++round) {
        sweep.along_x();
        sweep.along_y();
        sweep.along_z();
    }
    sweep.all_around();
    return band;
}

} // namespace meltscope
