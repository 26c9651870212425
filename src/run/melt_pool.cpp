#include "meltscope/run/measure.hpp"

#include "hot_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
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

/// Distance of a point from a beam's axis, m.
double distance_from_axis(const BeamSnapshot& beam, const Vec3& point) {
    const Vec3 offset = point - beam.position;
    return (offset - offset.dot(beam.beam_direction) * beam.beam_direction).norm();
}

/// distance[region][beam], m, of the nearest node of each region.
std::vector<std::vector<double>> distances(const HotRegions& regions,
                                           const std::vector<BeamSnapshot>& beams) {
    std::vector<std::vector<double>> result(
        regions.count(), std::vector<double>(beams.size(), std::numeric_limits<double>::infinity()));
    const auto& [first, last] = regions.box();
    for (std::int64_t k = first[2]; k <= last[2]; ++k)
        for (std::int64_t j = first[1]; j <= last[1]; ++j)
            for (std::int64_t i = first[0]; i <= last[0]; ++i)
                if (const int region = regions.at(i, j, k); region >= 0)
                    for (std::size_t n = 0; n < beams.size(); ++n)
                        result[region][n] =
                            std::min(result[region][n], distance_from_axis(beams[n], regions.place(i, j, k)));
    return result;
}

/// What a region is measured by, in the frame of its scan direction.
struct Measure {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    double cells = 0.0; ///< volume
    Vec3 moment = Vec3::Zero();
    double peak = 0.0;
    Vec3 hottest = Vec3::Zero(); ///< where the peak is

    void take(const Vec3& in_frame, const Vec3& point, double temperature) {
        low = low.cwiseMin(in_frame);
        high = high.cwiseMax(in_frame);
        if (temperature > peak) {
            peak = temperature;
            hottest = point;
        }
    }
};

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

std::vector<Measure> measure(const NodeLattice& nodes, const std::vector<double>& temperature,
                             const std::vector<double>& phi, double isotherm, const HotRegions& regions,
                             const Vec3& scan) {
    std::vector<Measure> measures(regions.count());
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

} // namespace

Vec3 level_direction(const BeamSnapshot& beam) {
    Vec3 along = beam.scan_direction;
    for (std::size_t i = beam.path_done.size(); along.norm() < 0.5 && i > 1; --i)
        if (const Vec3 came = beam.path_done[i - 1].position - beam.path_done[i - 2].position;
            came.norm() > 0.0)
            along = came.normalized();
    along.z() = 0.0;
    return along.norm() > 1e-12 ? Vec3(along.normalized()) : Vec3(Vec3::UnitX());
}

IsothermPools measure_pools(const NodeLattice& nodes, const std::vector<double>& temperature,
                            const std::vector<double>& phi, double isotherm,
                            const std::vector<BeamSnapshot>& beams) {
    const HotRegions regions(nodes, temperature, phi, isotherm);
    const std::vector<std::vector<double>> away = distances(regions, beams);
    // Every region along every direction that a beam has; most beams share one, be it forward or back.
    std::vector<Vec3> directions;
    std::vector<std::size_t> direction_of; // a beam
    for (const BeamSnapshot& beam : beams) {
        const Vec3 along = level_direction(beam);
        const auto same = std::find_if(directions.begin(), directions.end(), [&](const Vec3& other) {
            return std::abs(other.dot(along)) > 1.0 - 1e-12;
        });
        direction_of.push_back(std::size_t(same - directions.begin()));
        if (same == directions.end())
            directions.push_back(along);
    }
    if (directions.empty())
        directions.push_back(Vec3::UnitX());
    std::vector<std::vector<Measure>> measures;
    for (const Vec3& direction : directions)
        measures.push_back(measure(nodes, temperature, phi, isotherm, regions, direction));

    const double cell = std::pow(nodes.spacing, 3);
    const auto figures = [&](int region, std::size_t direction) -> PoolFigures {
        const Measure& m = measures[direction][region];
        const Vec3 size = m.high - m.low;
        return {isotherm, size[0], size[1], size[2], m.cells * cell};
    };
    const auto nearest_beam = [&](int region) {
        return int(std::min_element(away[region].begin(), away[region].end()) - away[region].begin());
    };
    IsothermPools result;
    std::vector<int> own(beams.size(), -1);
    const auto is_there = [&](int n) { return measures[0][n].low[0] <= measures[0][n].high[0]; };
    for (int b = 0; b < int(beams.size()); ++b) {
        const auto volume = [&](int n) { return measures[0][n].cells; };
        int nearest = -1;
        for (int n = 0; n < regions.count(); ++n) {
            if (!is_there(n))
                continue;
            if (away[n][b] <= beams[b].spot_radius && (own[b] < 0 || volume(n) > volume(own[b])))
                own[b] = n;
            if (nearest < 0 || away[n][b] < away[nearest][b])
                nearest = n;
        }
        if (own[b] < 0 && nearest >= 0 && nearest_beam(nearest) == b)
            own[b] = nearest;
        result.of_beams.push_back(own[b] < 0 ? PoolFigures{isotherm, 0.0, 0.0, 0.0, 0.0}
                                             : figures(own[b], direction_of[b]));
    }
    for (int n = 0; n < regions.count(); ++n) {
        if (!is_there(n))
            continue; // hot beside the material only
        SeparatePool pool;
        for (int b = 0; b < int(beams.size()); ++b)
            if (own[b] == n)
                pool.beams.push_back(b);
        const std::size_t direction = !pool.beams.empty() ? direction_of[pool.beams.front()]
                                      : !beams.empty()    ? direction_of[nearest_beam(n)]
                                                          : 0;
        pool.figures = figures(n, direction);
        const Measure& m = measures[direction][n];
        pool.center = m.cells > 0.0 ? Vec3(m.moment / m.cells) : m.hottest;
        pool.peak = m.peak;
        result.pools.push_back(pool);
    }
    std::stable_sort(
        result.pools.begin(), result.pools.end(),
        [](const SeparatePool& a, const SeparatePool& b) { return a.figures.volume > b.figures.volume; });
    return result;
}

void measure_pools(const std::vector<double>& isotherms, Snapshot& snapshot) {
    for (const double isotherm : isotherms) {
        const IsothermPools found =
            measure_pools(snapshot.nodes, *snapshot.temperature, *snapshot.phi, isotherm, snapshot.beams);
        for (std::size_t b = 0; b < snapshot.beams.size(); ++b)
            snapshot.beams[b].pools.push_back(found.of_beams[b]);
        snapshot.pools.push_back(!found.of_beams.empty() ? found.of_beams.front()
                                 : !found.pools.empty()  ? found.pools.front().figures
                                                         : PoolFigures{isotherm, 0.0, 0.0, 0.0, 0.0});
        snapshot.separate_pools.insert(snapshot.separate_pools.end(), found.pools.begin(), found.pools.end());
    }
}

} // namespace meltscope
