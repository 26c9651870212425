#include "meltscope/beam/illumination.hpp"

#include "meltscope/beam/profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope {
namespace {

/// Rays a cell along each direction across the beam.
constexpr double rays_in_cell = 2.0;

/// An element that lies this much deeper than the first interface, in cells, is still lit: the two are found
/// in different ways, and the map's rays pass up to a quarter cell beside the element.
constexpr double lit_tolerance = 1.0;

/// Trilinear level set; outside the box there is no material.
double level_set_at(const Grid& grid, const Field& phi, const Vec3& point) {
    std::array<std::int64_t, 3> cell;
    Vec3 r;
    for (int axis = 0; axis < 3; ++axis) {
        const double cells_in = (point[axis] - grid.origin[axis]) / grid.dx;
        cell[axis] = std::clamp(std::int64_t(std::floor(cells_in)), std::int64_t(0), grid.cells[axis] - 1);
        r[axis] = std::clamp(cells_in - double(cell[axis]), 0.0, 1.0);
    }
    double sum = 0.0;
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i)
                sum += (i ? r[0] : 1.0 - r[0]) * (j ? r[1] : 1.0 - r[1]) * (k ? r[2] : 1.0 - r[2]) *
                       phi[grid.index(cell[0] + i, cell[1] + j, cell[2] + k)];
    return sum;
}

/// The stretch of the ray that lies in the box, as distances from its start; empty if first > last.
struct Stretch {
    double first, last;
};

Stretch clip(const Grid& grid, const Vec3& start, const Vec3& direction) {
    Stretch s{0.0, std::numeric_limits<double>::infinity()};
    const Vec3 low = grid.origin, high = grid.upper_corner();
    for (int axis = 0; axis < 3; ++axis) {
        if (std::abs(direction[axis]) < 1e-12) {
            if (start[axis] < low[axis] || start[axis] > high[axis])
                return {1.0, 0.0};
            continue;
        }
        const double a = (low[axis] - start[axis]) / direction[axis];
        const double b = (high[axis] - start[axis]) / direction[axis];
        s.first = std::max(s.first, std::min(a, b));
        s.last = std::min(s.last, std::max(a, b));
    }
    return s;
}

/// Distance along the ray to the first interface, infinite if it meets none. phi is a distance, so that steps
/// of its size cannot jump over material.
double first_interface(const Grid& grid, const Field& phi, const Vec3& start, const Vec3& direction) {
    const Stretch s = clip(grid, start, direction);
    const double shortest = 0.1 * grid.dx;
    double t = s.first, before = s.first, phi_before = 0.0;
    while (t <= s.last) {
        const double value = level_set_at(grid, phi, start + t * direction);
        if (value <= 0.0) {
            const double fall = phi_before - value;
            return fall > 0.0 ? before + (t - before) * phi_before / fall : t;
        }
        before = t;
        phi_before = value;
        t += std::max(shortest, 0.9 * value);
    }
    return std::numeric_limits<double>::infinity();
}

/// Index of the map cell that holds a point, or -1 outside the map.
std::int64_t map_cell(const LightMap& map, const Vec3& point) {
    const Vec3 offset = point - map.corner;
    const double a = std::floor(offset.dot(map.u) / map.spacing + 0.5);
    const double b = std::floor(offset.dot(map.v) / map.spacing + 0.5);
    if (a < 0.0 || b < 0.0 || a >= double(map.count_u) || b >= double(map.count_v))
        return -1;
    return std::int64_t(a) + map.count_u * std::int64_t(b);
}

/// Share of the beam's power that meets material, by the map's rays.
double share_that_meets_material(const LightMap& map, const BeamShape& shape, const Vec3& position,
                                 double cutoff) {
    const Vec3 offset = position - map.corner;
    const double centre_u = offset.dot(map.u) / map.spacing, centre_v = offset.dot(map.v) / map.spacing;
    const std::int64_t reach = std::int64_t(std::ceil(cutoff / map.spacing)) + 1;
    const std::int64_t first_u = std::int64_t(std::floor(centre_u)) - reach;
    const std::int64_t first_v = std::int64_t(std::floor(centre_v)) - reach;
    double all = 0.0, met = 0.0;
    for (std::int64_t b = first_v; b <= first_v + 2 * reach + 1; ++b)
        for (std::int64_t a = first_u; a <= first_u + 2 * reach + 1; ++a) {
            const double du = (double(a) - centre_u) * map.spacing, dv = (double(b) - centre_v) * map.spacing;
            const double intensity = flux(shape, 1.0, du * du + dv * dv);
            if (intensity == 0.0)
                continue;
            all += intensity;
            const bool in_map = a >= 0 && b >= 0 && a < map.count_u && b < map.count_v;
            if (in_map && std::isfinite(map.depth[a + map.count_u * b]))
                met += intensity;
        }
    return all > 0.0 ? met / all : 0.0;
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
    return map;
}

Absorption absorb(const LightMap& map, const Laser& laser, const Vec3& position, double power,
                  const SurfaceElements& elements, std::vector<double>& element_power) {
    Absorption result;
    if (power <= 0.0)
        return result;
    const BeamShape shape = beam_shape(laser);
    const double share = share_that_meets_material(map, shape, position, cutoff_radius(laser));
    result.missed = power * (1.0 - share);

    std::vector<std::int64_t> hit;
    std::vector<double> raw; // W
    double sum = 0.0;
    for (std::int64_t s = 0; s < elements.count(); ++s) {
        if (!map.lit[s])
            continue;
        const double squared = axis_distance_squared(elements.point[s], position, map.direction);
        if (!(squared < shape.cutoff_squared))
            continue;
        const double cosine = -elements.normal[s].dot(map.direction);
        hit.push_back(s);
        raw.push_back(laser.absorptivity * flux(shape, power, squared) * cosine * elements.area[s]);
        sum += raw.back();
    }
    if (sum <= 0.0) // light falls on a body that has no free surface there
        return {0.0, power, 1.0};
    result.absorbed = laser.absorptivity * power * share;
    result.scale = result.absorbed / sum;
    for (std::size_t h = 0; h < hit.size(); ++h)
        element_power[hit[h]] += result.scale * raw[h];
    return result;
}

} // namespace meltscope
