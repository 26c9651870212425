#pragma once

#include "meltscope/beam/illumination.hpp"

#include <cmath>

namespace meltscope {

/// Share of a beam's power that meets material, by the map's rays. The beam's axis goes through `position`;
/// `intensity(aside)` is its flux, in any unit, at a place `aside` (m, across the beam) of the axis, zero
/// beyond `cutoff` (m).
template <class Intensity>
double share_that_meets_material(const LightMap& map, const Vec3& position, double cutoff,
                                 Intensity intensity) {
    const Vec3 offset = position - map.corner;
    const double centre_u = offset.dot(map.u) / map.spacing, centre_v = offset.dot(map.v) / map.spacing;
    const std::int64_t reach = std::int64_t(std::ceil(cutoff / map.spacing)) + 1;
    const std::int64_t first_u = std::int64_t(std::floor(centre_u)) - reach;
    const std::int64_t first_v = std::int64_t(std::floor(centre_v)) - reach;
    double all = 0.0, met = 0.0;
    for (std::int64_t b = first_v; b <= first_v + 2 * reach + 1; ++b)
        for (std::int64_t a = first_u; a <= first_u + 2 * reach + 1; ++a) {
            const Vec3 aside =
                map.spacing * ((double(a) - centre_u) * map.u + (double(b) - centre_v) * map.v);
            const double here = intensity(aside);
            if (here == 0.0)
                continue;
            all += here;
            const bool in_map = a >= 0 && b >= 0 && a < map.count_u && b < map.count_v;
            if (in_map && std::isfinite(map.depth[a + map.count_u * b]))
                met += here;
        }
    return all > 0.0 ? met / all : 0.0;
}

} // namespace meltscope
