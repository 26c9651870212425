#include "meltscope/run/measure.hpp"

#include "region_measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope {
namespace {

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
    std::vector<std::vector<RegionMeasure>> measures;
    for (const Vec3& direction : directions)
        measures.push_back(measure_regions(regions, nodes, temperature, phi, isotherm, direction));

    const double cell = std::pow(nodes.spacing, 3);
    const auto figures = [&](int region, std::size_t direction) -> PoolFigures {
        const RegionMeasure& m = measures[direction][region];
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
        const RegionMeasure& m = measures[direction][n];
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
