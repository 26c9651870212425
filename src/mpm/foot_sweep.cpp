#include "foot_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

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
        : grid_(grid), band_(band), nearest_(nearest) {
        for (auto* field : {&x_, &y_, &z_, &squared_})
            *field = std::make_unique_for_overwrite<double[]>(grid.size);
        // Ghosts and what else lies beside the band have no foot, which says that the rest is not set.
        band_.for_each_node(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at) {
            const Vec3 node = grid.position(i, j, k);
            const bool has_one = nearest_[at] >= 0;
            const Vec3 foot = has_one ? feet[nearest_[at]].point : node;
            x_[at] = foot[0];
            y_[at] = foot[1];
            z_[at] = foot[2];
            squared_[at] = has_one ? (node - foot).squaredNorm() : reach * reach;
        });
    }

    void along_x() {
#pragma omp parallel for schedule(dynamic, 1)
        for (std::int64_t k = 0; k <= grid_.cells[2]; ++k)
            for (std::int64_t j = 0; j <= grid_.cells[1]; ++j) {
                const Stretch& row = band_.of_row(j, k);
                if (row.first < row.last) {
                    hand_on(row.first, row.last, 1, j, k);
                    hand_on(row.last, row.first, -1, j, k);
                }
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
    /// a node whose own foot lies askew. Only indices change, so that each is offered what was there before.
    void all_around() {
        const auto before = std::make_unique_for_overwrite<std::int32_t[]>(grid_.size);
#pragma omp parallel for schedule(static)
        for (std::int64_t k = -1; k <= grid_.cells[2] + 1; ++k)
            if (band_.reaches_plane(k - 1) || band_.reaches_plane(k) || band_.reaches_plane(k + 1))
                std::copy_n(&nearest_[grid_.index(-1, -1, k)], grid_.stride_z,
                            &before[grid_.index(-1, -1, k)]);
#pragma omp parallel for schedule(dynamic, 1)
        for (std::int64_t k = 0; k <= grid_.cells[2]; ++k)
            for (std::int64_t j = 0; j <= grid_.cells[1]; ++j)
                look_around(before.get(), j, k, std::make_integer_sequence<int, 27>());
    }

  private:
    /// Along row (j,k) from node `first` to `last`: each takes the foot of the one before if it is nearer.
    void hand_on(std::int64_t first, std::int64_t last, std::int64_t step, std::int64_t j, std::int64_t k) {
        const Vec3 row = grid_.position(0, j, k);
        const std::int64_t start = grid_.index(0, j, k);
        std::int64_t at = start + first;
        std::int32_t foot = nearest_[at];
        double x = x_[at], y = y_[at], z = z_[at];
        for (std::int64_t i = first + step; i != last + step; i += step) {
            at = start + i;
            const double away_x = row[0] + grid_.dx * double(i) - x, away_y = row[1] - y, away_z = row[2] - z;
            const double squared = away_x * away_x + away_y * away_y + away_z * away_z;
            if (foot >= 0 && squared < squared_[at]) {
                squared_[at] = squared;
                nearest_[at] = foot;
                x_[at] = x;
                y_[at] = y;
                z_[at] = z;
            } else {
                foot = nearest_[at];
                x = x_[at];
                y = y_[at];
                z = z_[at];
            }
        }
    }

    /// The band's nodes of row (j,k) take the foot of the node `from` further in storage, in another row, if
    /// it is nearer than their own.
    void offer_to_row(std::int64_t j, std::int64_t k, std::int64_t from) {
        const Stretch& stretch = band_.of_row(j, k);
        const Vec3 row = grid_.position(0, j, k);
        const double dx = grid_.dx;
        const std::int64_t start = grid_.index(0, j, k);
        double *x = x_.get() + start, *y = y_.get() + start, *z = z_.get() + start;
        double* least = squared_.get() + start;
        std::int32_t* nearest = nearest_.data() + start;
#pragma omp simd
        for (std::int64_t i = stretch.first; i <= stretch.last; ++i) {
            const std::int32_t foot = nearest[i + from];
            const double foot_x = x[i + from], foot_y = y[i + from], foot_z = z[i + from];
            const double away_x = row[0] + dx * double(i) - foot_x, away_y = row[1] - foot_y,
                         away_z = row[2] - foot_z;
            const double squared = away_x * away_x + away_y * away_y + away_z * away_z;
            const bool nearer = (foot >= 0) & (squared < least[i]);
            least[i] = nearer ? squared : least[i];
            nearest[i] = nearer ? foot : nearest[i];
            x[i] = nearer ? foot_x : x[i];
            y[i] = nearer ? foot_y : y[i];
            z[i] = nearer ? foot_z : z[i];
        }
    }

    /// The band's nodes of row (j,k) take the nearest of the feet that they and their neighbours had
    /// `before`, neighbours told apart by n = 0 .. 26.
    template <int... n>
    void look_around(const std::int32_t* before, std::int64_t j, std::int64_t k,
                     std::integer_sequence<int, n...>) {
        const Stretch& stretch = band_.of_row(j, k);
        const Vec3 row = grid_.position(0, j, k);
        const double dx = grid_.dx;
        const std::int64_t start = grid_.index(0, j, k), stride_y = grid_.stride_y, stride_z = grid_.stride_z;
        const double *x = x_.get() + start, *y = y_.get() + start, *z = z_.get() + start;
        const double* squared = squared_.get() + start;
        std::int32_t* nearest = nearest_.data() + start;
        before += start;
#pragma omp simd
        for (std::int64_t i = stretch.first; i <= stretch.last; ++i) {
            double least = squared[i];
            std::int32_t best = nearest[i];
            const auto offer = [&](std::int64_t from) {
                const double away_x = row[0] + dx * double(i) - x[from], away_y = row[1] - y[from],
                             away_z = row[2] - z[from];
                const double distance = away_x * away_x + away_y * away_y + away_z * away_z;
                const bool nearer = (before[from] >= 0) & (distance < least);
                least = nearer ? distance : least;
                best = nearer ? before[from] : best;
            };
            (offer(i + (n % 3 - 1) + (n / 3 % 3 - 1) * stride_y + (n / 9 - 1) * stride_z), ...);
            nearest[i] = best;
        }
    }

    const Grid& grid_;
    const NodeBand& band_;
    std::vector<std::int32_t>& nearest_;
    // Of the band's nodes only: m, where their feet are, so that neighbours find them side by side; m^2.
    std::unique_ptr<double[]> x_, y_, z_, squared_;
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
