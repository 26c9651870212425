#pragma once

#include "meltscope/beam/laser.hpp"
#include "meltscope/mpm/free_surface.hpp"

#include <vector>

namespace meltscope {

/// What parallel light of one direction meets first, seen as a map across the beam. Stands as long as the
/// geometry.
struct LightMap {
    Vec3 direction{0, 0, -1}; ///< unit, the way the light travels
    Vec3 u, v;                ///< unit, across the beam
    Vec3 corner;              ///< m, centre of cell (0,0), outside the box on the side of the source
    double spacing = 0.0;     ///< m
    std::int64_t count_u = 0, count_v = 0;
    std::vector<double>
        depth; ///< m along the beam from the corner's plane to the first interface; infinite: none
    std::vector<char> lit; ///< of each surface element: nothing lies between it and the source
    std::vector<std::int64_t> lit_in_cells; ///< the lit elements, cell after cell in the order of `depth`
    std::vector<std::int64_t> cell_start;   ///< first entry of each cell, and the end
};

/// Traces a ray through the level set for every half cell across the beam.
LightMap make_light_map(const Grid& grid, const FreeSurface& surface, const Vec3& direction);

/// What a beam leaves on the surface.
struct Absorption {
    double absorbed =
        0.0; ///< W, into the material: absorptivity x power x share of the footprint that meets material
    double missed = 0.0; ///< W, light that meets no material
    double scale = 1.0;  ///< factor that made the sum over the elements exact
};

/// Finds the power in W that surface elements absorb from `laser`, its axis through `position`, emitting
/// `power` W: absorptivity I(x_s) max(0, -d . n) a, where lit, scaled so that the sum is Absorption::absorbed
/// exactly.
Absorption absorb(const LightMap& map, const Laser& laser, const Vec3& position, double power,
                  const SurfaceElements& elements, ElementHeat& absorbed);

} // namespace meltscope
