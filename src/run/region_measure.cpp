#include "region_measure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace meltscope {
namespace {

/// Points tried a cell along each axis where an isotherm or the surface cuts the cell.
constexpr int volume_samples = 4;

/// Along an edge, r from 0 to 1, the stretch that is hot (T > isotherm) and inside (phi < 0).
struct Stretch {
    double first = 0.0, last = 1.0;

    void cut(double at_0, double at_1) { // keep where a linear function is positive
        if (at_0 <= 0.0 && at_1 <= 0.0)
            first = 1.0, last = 0.0;
        else if (at_0 <= 0.0)
            first = std::max(first, at_0 / (at_0 - at_1));
        else if (at_1 <= 0.0)
            last = std::min(last, at_0 / (at_0 - at_1));
    }
    bool empty() const { return first > last; }
};

/// Where two functions that are linear in a triangle are both zero: barycentric coordinates, if that is in
/// it.
std::optional<std::array<double, 3>> common_zero(const std::array<double, 3>& f,
                                                 const std::array<double, 3>& g) {
    std::array<double, 3> b{f[1] * g[2] - f[2] * g[1], f[2] * g[0] - f[0] * g[2], f[0] * g[1] - f[1] * g[0]};
    const double sum = b[0] + b[1] + b[2];
    if (sum == 0.0)
        return std::nullopt;
    for (double& share : b) {
        share /= sum;
        if (!(share >= 0.0))
            return std::nullopt;
    }
    return b;
}

/// Volume in a cell of the region hot and inside, corner values x fastest.
double cell_volume(const std::array<double, 8>& hot, const std::array<double, 8>& inside) {
    const auto positive = [](double v) { return v > 0.0; };
    if (std::all_of(hot.begin(), hot.end(), positive) && std::all_of(inside.begin(), inside.end(), positive))
        return 1.0;
    if (std::none_of(hot.begin(), hot.end(), positive) ||
        std::none_of(inside.begin(), inside.end(), positive))
        return 0.0;
    const auto trilinear = [](const std::array<double, 8>& f, double x, double y, double z) {
        const auto mix = [](double a, double b, double r) { return a + r * (b - a); };
        return mix(mix(mix(f[0], f[1], x), mix(f[2], f[3], x), y),
                   mix(mix(f[4], f[5], x), mix(f[6], f[7], x), y), z);
    };
    int count = 0;
    for (int c = 0; c < volume_samples; ++c)
        for (int b = 0; b < volume_samples; ++b)
            for (int a = 0; a < volume_samples; ++a) {
                const double x = (a + 0.5) / volume_samples, y = (b + 0.5) / volume_samples,
                             z = (c + 0.5) / volume_samples;
                count += trilinear(hot, x, y, z) > 0.0 && trilinear(inside, x, y, z) > 0.0;
            }
    return double(count) / (volume_samples * volume_samples * volume_samples);
}

/// The fields relative to what bounds a pool.
struct Bounds {
    const std::vector<double>& temperature;
    const std::vector<double>& phi;
    double isotherm;
    double surface; ///< m, what counts as the free surface: nodes on it are in the material, whatever their
                    ///< round-off

    double hot(std::int64_t at) const { return temperature[at] - isotherm; }
    double inside(std::int64_t at) const { return surface - phi[at]; }
};

/// The points where the isotherm meets the free surface on the faces of the cells that begin at a node, of
/// both halves of each face. Between nodes, it is these that reach furthest.
template <class Take>
void rim_points(const HotRegions& regions, const Bounds& bounds, const std::array<std::int64_t, 3>& stride,
                const std::array<bool, 3>& has_next, const std::array<std::int64_t, 3>& node,
                const Take& take) {
    const std::int64_t at = regions.index(node[0], node[1], node[2]);
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        if (!has_next[u] || !has_next[v])
            continue;
        const std::array<std::int64_t, 4> corners{at, at + stride[u], at + stride[u] + stride[v],
                                                  at + stride[v]};
        const auto crossed = [&](const auto& value) {
            const auto positive = [&](std::int64_t corner) { return value(corner) > 0.0; };
            const auto count = std::count_if(corners.begin(), corners.end(), positive);
            return count > 0 && count < 4;
        };
        if (!crossed([&](std::int64_t c) { return bounds.hot(c); }) ||
            !crossed([&](std::int64_t c) { return bounds.inside(c); }))
            continue;
        std::array<std::array<std::int64_t, 3>, 4> places{node, node, node, node};
        ++places[1][u], ++places[2][u], ++places[2][v], ++places[3][v];
        int region = -1;
        for (const auto& [i, j, k] : places)
            region = std::max(region, regions.at(i, j, k));
        if (region < 0)
            continue;
        // Both ways to halve it, so that mirror images measure alike.
        for (const std::array<int, 3>& half :
             {std::array{0, 1, 2}, std::array{0, 2, 3}, std::array{0, 1, 3}, std::array{1, 2, 3}}) {
            std::array<double, 3> hot, inside;
            for (int n = 0; n < 3; ++n) {
                hot[n] = bounds.hot(corners[half[n]]);
                inside[n] = bounds.inside(corners[half[n]]);
            }
            const auto shares = common_zero(hot, inside);
            if (!shares)
                continue;
            Vec3 point = Vec3::Zero();
            for (int n = 0; n < 3; ++n) {
                const auto& [i, j, k] = places[half[n]];
                point += (*shares)[n] * regions.place(i, j, k);
            }
            take(region, point);
        }
    }
}

} // namespace

std::vector<RegionMeasure> measure_regions(const HotRegions& regions, const NodeLattice& nodes,
                                           const std::vector<double>& temperature,
                                           const std::vector<double>& phi, double isotherm,
                                           const Vec3& scan) {
    std::vector<RegionMeasure> measures(regions.count());
    const Bounds bounds{temperature, phi, isotherm, 1e-6 * nodes.spacing};
    const auto in_frame = [&](const Vec3& p) {
        return Vec3(p.dot(scan), scan.x() * p.y() - scan.y() * p.x(), p.z());
    };
    const std::array<std::int64_t, 3> stride{1, nodes.count[0], nodes.count[0] * nodes.count[1]};
    const auto& [first, last] = regions.box();
    for (std::int64_t k = first[2]; k <= last[2]; ++k)
        for (std::int64_t j = first[1]; j <= last[1]; ++j)
            for (std::int64_t i = first[0]; i <= last[0]; ++i) {
                const std::int64_t at = regions.index(i, j, k);
                const std::array<bool, 3> has_next{i < last[0], j < last[1], k < last[2]};
                const int here = regions.at(i, j, k);
                for (int axis = 0; axis < 3; ++axis) {
                    if (!has_next[axis])
                        continue;
                    const std::int64_t next = at + stride[axis];
                    const int there = regions.at(i + (axis == 0), j + (axis == 1), k + (axis == 2));
                    const int region = here >= 0 ? here : there;
                    if (region < 0)
                        continue;
                    Stretch stretch;
                    stretch.cut(bounds.hot(at), bounds.hot(next));
                    stretch.cut(bounds.inside(at), bounds.inside(next));
                    if (stretch.empty())
                        continue;
                    for (const double r : {stretch.first, stretch.last}) {
                        const Vec3 p = regions.place(i, j, k) + r * nodes.spacing * Vec3::Unit(axis);
                        measures[region].take(in_frame(p), p,
                                              std::lerp(temperature[at], temperature[next], r));
                    }
                }
                rim_points(regions, bounds, stride, has_next, {i, j, k}, [&](int region, const Vec3& p) {
                    measures[region].take(in_frame(p), p, isotherm);
                });
                if (!has_next[0] || !has_next[1] || !has_next[2])
                    continue;
                std::array<double, 8> hot, inside;
                int region = -1;
                for (int c = 0; c < 8; ++c) {
                    const int di = c & 1, dj = (c >> 1) & 1, dk = (c >> 2) & 1;
                    const std::int64_t corner = at + di + dj * stride[1] + dk * stride[2];
                    hot[c] = bounds.hot(corner);
                    inside[c] = bounds.inside(corner);
                    region = std::max(region, regions.at(i + di, j + dj, k + dk)); // a cell has one at most
                }
                if (region < 0)
                    continue;
                const double cells = cell_volume(hot, inside);
                measures[region].cells += cells;
                measures[region].moment +=
                    cells * (regions.place(i, j, k) + 0.5 * nodes.spacing * Vec3::Ones());
            }
    return measures;
}

} // namespace meltscope
