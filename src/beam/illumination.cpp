#include "meltscope/beam/illumination.hpp"

#include "meltscope/beam/profile.hpp"

#include "footprint.hpp"
#include "level_set_rays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace meltscope {
namespace {

/// Rays a cell along each direction across the beam.
constexpr double rays_in_cell = 2.0;

/// An element that lies this much deeper than the first interface, in cells, is still lit: the two are found
/// in different ways, and the map's rays pass up to a quarter cell beside the element.
constexpr double lit_tolerance = 1.0;

/// So few elements one thread has looked at before others would be awake.
constexpr std::int64_t few = 4096;

/// Index of the map cell that holds a point, or -1 outside the map.
std::int64_t map_cell(const LightMap& map, const Vec3& point) {
    const Vec3 offset = point - map.corner;
    const double a = std::floor(offset.dot(map.u) / map.spacing + 0.5);
    const double b = std::floor(offset.dot(map.v) / map.spacing + 0.5);
    if (a < 0.0 || b < 0.0 || a >= double(map.count_u) || b >= double(map.count_v))
        return -1;
    return std::int64_t(a) + map.count_u * std::int64_t(b);
}

/// Sorts the lit elements by the map's cells, so that a beam looks at those near it, in the order in which
/// they lie.
void sort_into_cells(const SurfaceElements& elements, LightMap& map) {
    map.cell_start.assign(map.depth.size() + 1, 0);
    std::vector<std::int64_t> cell(elements.count(), -1);
    for (std::int64_t s = 0; s < elements.count(); ++s)
        if (map.lit[s]) {
            cell[s] = map_cell(map, elements.point[s]);
            ++map.cell_start[cell[s] + 1];
        }
    std::partial_sum(map.cell_start.begin(), map.cell_start.end(), map.cell_start.begin());
    map.lit_in_cells.resize(map.cell_start.back());
    std::vector<std::int64_t> next(map.cell_start.begin(), map.cell_start.end() - 1);
    for (std::int64_t s = 0; s < elements.count(); ++s)
        if (map.lit[s])
            map.lit_in_cells[next[cell[s]]++] = s;
}

/// The map's cells along one axis that a stretch of it reaches, at least one.
struct CellRange {
    std::int64_t first, end;
};
CellRange cells_within(const LightMap& map, const Vec3& axis, std::int64_t count, const Vec3& centre,
                       double reach) {
    const double at = (centre - map.corner).dot(axis) / map.spacing + 0.5, wide = reach / map.spacing;
    const auto inside = [&](double cell) { return std::int64_t(std::clamp(cell, 0.0, double(count - 1))); };
    return {inside(std::floor(at - wide)), inside(std::floor(at + wide)) + 1};
}

} // namespace

LightMap make_light_map(const Grid& grid, const FreeSurface& surface, const Vec3& direction) {
    LightMap map;
    map.direction = direction.normalized();
    // Along the box's edges where the light is parallel to one, so that rays and nodes keep step.
    const Vec3 helper = std::abs(map.direction.x()) < 0.9 ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY());
    map.u = (helper - helper.dot(map.direction) * map.direction).normalized();
    map.v = map.direction.cross(map.u).normalized();
    map.spacing = grid.dx / rays_in_cell;

    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    const Vec3 size = grid.upper_corner() - grid.origin;
    for (int c = 0; c < 8; ++c) {
        const Vec3 p = grid.origin + size.cwiseProduct(Vec3(c & 1, (c >> 1) & 1, (c >> 2) & 1));
        const Vec3 seen(p.dot(map.u), p.dot(map.v), p.dot(map.direction));
        low = low.cwiseMin(seen);
        high = high.cwiseMax(seen);
    }
    map.count_u = std::max<std::int64_t>(1, std::int64_t(std::ceil((high[0] - low[0]) / map.spacing - 1e-6)));
    map.count_v = std::max<std::int64_t>(1, std::int64_t(std::ceil((high[1] - low[1]) / map.spacing - 1e-6)));
    map.corner =
        (low[0] + 0.5 * map.spacing) * map.u + (low[1] + 0.5 * map.spacing) * map.v + low[2] * map.direction;

    map.depth.resize(map.count_u * map.count_v);
#pragma omp parallel for schedule(dynamic, 8)
    for (std::int64_t b = 0; b < map.count_v; ++b)
        for (std::int64_t a = 0; a < map.count_u; ++a)
            map.depth[a + map.count_u * b] = first_interface(
                grid, surface.phi, map.corner + map.spacing * (double(a) * map.u + double(b) * map.v),
                map.direction);

    const SurfaceElements& elements = surface.elements;
    map.lit.resize(elements.count());
#pragma omp parallel for schedule(static)
    for (std::int64_t s = 0; s < elements.count(); ++s) {
        const std::int64_t cell = map_cell(map, elements.point[s]);
        map.lit[s] =
            cell >= 0 && elements.normal[s].dot(map.direction) < 0.0 &&
            (elements.point[s] - map.corner).dot(map.direction) <= map.depth[cell] + lit_tolerance * grid.dx;
    }
    sort_into_cells(elements, map);
    return map;
}

Absorption absorb(const LightMap& map, const Laser& laser, const Vec3& position, double power,
                  const SurfaceElements& elements, ElementHeat& absorbed) {
    Absorption result;
    absorbed.element.clear();
    absorbed.amount.clear();
    if (power <= 0.0)
        return result;
    const BeamShape shape = beam_shape(laser);
    const double share =
        share_that_meets_material(map, position, cutoff_radius(laser),
                                  [&](const Vec3& aside) { return flux(shape, 1.0, aside.squaredNorm()); });
    result.missed = power * (1.0 - share);

    const double reach = std::sqrt(shape.cutoff_squared);
    const CellRange along_u = cells_within(map, map.u, map.count_u, position, reach);
    const CellRange along_v = cells_within(map, map.v, map.count_v, position, reach);
    const auto first_lit = [&](std::int64_t row) {
        return map.cell_start[along_u.first + map.count_u * row];
    };
    const auto end_lit = [&](std::int64_t row) { return map.cell_start[along_u.end + map.count_u * row]; };
    const bool many = end_lit(along_v.end - 1) - first_lit(along_v.first) > few;
    // A list and a sum a row of cells, then these in their order: the same for any number of threads.
    std::vector<ElementHeat> of_row(along_v.end - along_v.first);
    std::vector<double> sum_of_row(of_row.size(), 0.0);
#pragma omp parallel for schedule(dynamic, 1) if (many)
    for (std::int64_t row = along_v.first; row < along_v.end; ++row) {
        ElementHeat heat; // put into the list when whole: threads would share its neighbours' cache lines
        double sum = 0.0;
        for (std::int64_t n = first_lit(row); n < end_lit(row); ++n) {
            const std::int64_t s = map.lit_in_cells[n];
            const double squared = axis_distance_squared(elements.point[s], position, map.direction);
            if (!(squared < shape.cutoff_squared))
                continue;
            const double cosine = -elements.normal[s].dot(map.direction);
            const double watt = laser.absorptivity * flux(shape, power, squared) * cosine * elements.area[s];
            heat.element.push_back(s);
            heat.amount.push_back(watt);
            sum += watt;
        }
        of_row[row - along_v.first] = std::move(heat);
        sum_of_row[row - along_v.first] = sum;
    }
    double sum = 0.0;
    for (std::size_t row = 0; row < of_row.size(); ++row) {
        sum += sum_of_row[row];
        const ElementHeat& some = of_row[row];
        absorbed.element.insert(absorbed.element.end(), some.element.begin(), some.element.end());
        absorbed.amount.insert(absorbed.amount.end(), some.amount.begin(), some.amount.end());
    }
    if (sum <= 0.0) { // light falls on a body that has no free surface there
        absorbed = {};
        return {0.0, power, 1.0};
    }
    result.absorbed = laser.absorptivity * power * share;
    result.scale = result.absorbed / sum;
    for (double& watt : absorbed.amount)
        watt *= result.scale;
    return result;
}

} // namespace meltscope
