#include "meltscope/mpm/level_set.hpp"

#include "foot_sweep.hpp"
#include "tile_flags.hpp"

#include "meltscope/mpm/boundary.hpp"
#include "meltscope/mpm/group_stencils.hpp"
#include "meltscope/mpm/trilinear.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace meltscope {
namespace {

/// Nodes this close to the surface, in cells, find it themselves. More than half a cell's diagonal, so that
/// no part of the surface is missed; less than the reach of the smoothed profile, so that it can be inverted.
constexpr double seed_band = 0.9;

/// Where the smoothed distance at a foot is further from zero than this, in cells, there is no surface:
/// particles that stand unevenly make the fraction dip inside a body too.
constexpr double foot_tolerance = 0.4;

/// A particle this far outside the surface, in cells, has been smoothed away and gets a ball of its own.
constexpr double smoothed_away = 0.25;

/// Where the volume fraction differs from one by no more than round-off, no surface is near.
constexpr double fill_round_off = 1e-13;

/// The distance that the smoothed fraction tells where it is zero, in cells; minus this where it is one.
constexpr double beyond_smoothing = 1.5;

/// What a tile has among its bins: some that hold material, some that miss some.
constexpr unsigned char holds = 1, lacks = 2, both = holds | lacks;

Vec3 central_difference(const Grid& grid, const Field& f, std::int64_t at) {
    return Vec3(f[at + 1] - f[at - 1], f[at + grid.stride_y] - f[at - grid.stride_y],
                f[at + grid.stride_z] - f[at - grid.stride_z]) /
           (2.0 * grid.dx);
}

/// What the bins around each tile have. A place with groups of two materials counts as not full.
TileFlags find_fill(const Grid& grid, const Particles& particles) {
    TileFlags fill(grid);
    fill.set(grid, [](std::int64_t, std::int64_t, std::int64_t, std::int64_t) { return lacks; });
    const LaneLayout& layout = particles.layout;
#pragma omp parallel for schedule(static)
    for (std::size_t b = 0; b < layout.blocks.size(); ++b) // blocks have no tile in common
        for (std::int64_t g = layout.blocks[b].first_group; g < layout.blocks[b].last_group; ++g)
            fill[fill.tile_of(layout.groups[g])] = particles.full[g] ? holds : both;
    fill.widen();
    return fill;
}

/// Distance to the surface in cells as the smoothed volume fraction tells it; good within about one cell.
/// Particles are looked at only near tiles whose surroundings are neither full nor empty.
Field smoothed_distance(const Grid& grid, const Particles& particles) {
    const TileFlags fill = find_fill(grid, particles);
    TileFlags reached(grid);
    for (std::int64_t tile = 0; tile < fill.count(); ++tile)
        reached[tile] = fill[tile] == both;
    reached.widen();

    Field fraction(grid.size, 0.0);
    const LatticeStencils lattices;
    for_each_block(particles.layout, [&](const LaneBlock& block) {
        for (std::int64_t g = block.first_group; g < block.last_group; ++g) {
            const LaneGroup& group = particles.layout.groups[g];
            if (reached[reached.tile_of(group)])
                scatter_group(grid, particles, lattices, group, particles.volume, fraction);
        }
    });
    fold_ghosts(grid, Boundary{}, AtFixedFaces::leave, fraction);
    const double cell = grid.dx * grid.dx * grid.dx;
    for_each_tile(grid, [&](std::int64_t first, std::int64_t end, std::int64_t j, std::int64_t k) {
        double* row = &fraction[grid.index(0, j, k)];
        const unsigned char around = fill[fill.tile_of(first, j, k)];
        if (around != both) {
            std::fill(row + first, row + end, around == holds ? -beyond_smoothing : beyond_smoothing);
            return;
        }
        for (std::int64_t i = first; i < end; ++i) {
            const double filled = row[i] / (cell * grid.share_in_box(i, j, k));
            row[i] = filled >= 1.0 - fill_round_off ? -beyond_smoothing : distance_of_fraction(filled);
        }
    });
    mirror_ghosts(grid, Boundary{}, fraction);
    return fraction;
}

/// Foot points of all nodes next to the surface, and the node-wise index of a node's own foot (-1: none).
std::vector<Foot> find_feet(const Grid& grid, const Field& distance, std::vector<std::int32_t>& nearest) {
    std::vector<std::vector<Foot>> feet_of_layer(grid.cells[2] + 1);
    nearest.assign(grid.size, -1);
    for_each_tile(grid, [&](std::int64_t first, std::int64_t end, std::int64_t j, std::int64_t k) {
        if (none_of(abs(load(&distance[grid.index(first, j, k)])) < seed_band))
            return;
        for (std::int64_t i = first; i < end; ++i) {
            const std::int64_t at = grid.index(i, j, k);
            if (std::abs(distance[at]) >= seed_band)
                continue;
            const Vec3 gradient = central_difference(grid, distance, at);
            if (gradient.norm() * grid.dx < 0.1)
                continue; // a gap or a sheet thinner than the grid can see
            const Vec3 normal = gradient.normalized();
            const Vec3 foot = grid.position(i, j, k) - distance[at] * grid.dx * normal;
            if (std::abs(trilinear(grid, distance, foot)) > foot_tolerance)
                continue;
            nearest[at] = std::int32_t(feet_of_layer[k].size());
            feet_of_layer[k].push_back({foot, normal});
        }
    });
    std::vector<Foot> feet;
    std::vector<std::int32_t> before(grid.cells[2] + 1);
    for (std::int64_t k = 0; k <= grid.cells[2]; ++k) {
        before[k] = std::int32_t(feet.size());
        feet.insert(feet.end(), feet_of_layer[k].begin(), feet_of_layer[k].end());
    }
#pragma omp parallel for schedule(static)
    for (std::int64_t k = 0; k <= grid.cells[2]; ++k)
        if (before[k] > 0 && !feet_of_layer[k].empty())
            for (std::int64_t at = grid.index(0, 0, k); at <= grid.index(grid.cells[0], grid.cells[1], k);
                 ++at)
                nearest[at] += nearest[at] >= 0 ? before[k] : 0;
    return feet;
}

/// Distance in m from `point` to the surface near `foot`: to the tangent plane, corrected by what the
/// smoothed fraction says at the point met there.
double distance_near(const Grid& grid, const Field& smoothed, const Vec3& point, const Foot& foot) {
    const Vec3 from_foot = point - foot.point;
    const double height = from_foot.dot(foot.normal);
    Vec3 aside = from_foot - height * foot.normal;
    if (aside.norm() > grid.dx)
        aside.setZero(); // an edge or a tip: the foot itself is nearest
    const Vec3 on_plane = foot.point + aside;
    const double left = std::clamp(trilinear(grid, smoothed, on_plane), -seed_band, seed_band);
    return (point - (on_plane - left * grid.dx * foot.normal)).norm();
}

/// Smoothing draws the level one half of a curved surface towards its centre of curvature, by half the
/// B-spline's variance (dx^2/4 along each axis) times div n = laplacian of phi: phi -= dx^2/8 laplacian(phi)
/// puts it back. Second differences over two cells, so that the steps of a lattice do not pass for curvature.
void undo_shift_by_curvature(const Grid& grid, const NodeBand& band, Field& phi) {
    const auto shift = std::make_unique_for_overwrite<double[]>(grid.size);
    const std::array<std::int64_t, 3> stride{1, grid.stride_y, grid.stride_z};
    band.for_each_node(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at) {
        shift[at] = 0.0;
        if (std::abs(phi[at]) > 3.0 * grid.dx)
            return;
        const std::array<std::int64_t, 3> node{i, j, k};
        double laplacian = 0.0; // times dx^2
        for (int axis = 0; axis < 3; ++axis) {
            const std::int64_t last = grid.cells[axis];
            const auto two_off = [&](std::int64_t step) { // mirrored at the box's faces
                const std::int64_t n = std::abs(node[axis] + step);
                return phi[at + ((n > last ? std::abs(2 * last - n) : n) - node[axis]) * stride[axis]];
            };
            laplacian += (two_off(2) - 2.0 * phi[at] + two_off(-2)) / 4.0;
        }
        shift[at] = std::clamp(laplacian, -grid.dx, grid.dx) / 8.0;
    });
    band.for_each_node(
        grid, [&](std::int64_t, std::int64_t, std::int64_t, std::int64_t at) { phi[at] -= shift[at]; });
}

/// A particle that stands outside the smoothed surface.
struct LoneParticle {
    Index3 node;   // of its bin
    Vec3 position; // m
    double volume; // m^3
};

/// The particles outside the smoothed surface, in the order of the layout. Only groups of which one of the
/// nodes around lies outside are looked at.
std::vector<LoneParticle> lone_particles(const Grid& grid, const Particles& particles, const Field& phi) {
    const double outside = smoothed_away * grid.dx;
    TileFlags some_outside(grid);
    some_outside.set(grid, [&](std::int64_t i, std::int64_t end, std::int64_t j, std::int64_t k) {
        if (end - i == lane_count)
            return any_of(load(&phi[grid.index(i, j, k)]) > outside);
        const double* row = &phi[grid.index(0, j, k)];
        return std::any_of(row + i, row + end, [&](double distance) { return distance > outside; });
    });
    some_outside.widen();

    const auto& groups = particles.layout.groups;
    constexpr std::size_t chunk = 256; // groups, so that the order does not depend on the threads
    std::vector<std::vector<LoneParticle>> lone((groups.size() + chunk - 1) / chunk);
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t c = 0; c < lone.size(); ++c)
        for (std::size_t g = c * chunk; g < std::min(groups.size(), (c + 1) * chunk); ++g) {
            if (!some_outside[some_outside.tile_of(groups[g])])
                continue;
            const auto may_be = range_around(grid, phi, groups[g]).most > outside; // the same of each bin
            if (none_of(may_be))
                continue;
            const std::int64_t first = groups[g].first_slot * lane_count;
            for (std::int64_t at = first; at < first + groups[g].slots * lane_count; ++at) {
                if (!may_be[at % lane_count] || !(particles.volume[at] > 0.0))
                    continue;
                const Index3 node(groups[g].corner % grid.stride_y + at % lane_count,
                                  groups[g].corner % grid.stride_z / grid.stride_y,
                                  groups[g].corner / grid.stride_z);
                const Vec3 position = grid.position(node[0], node[1], node[2]) +
                                      grid.dx * offset_in_bin(particles, groups[g], at);
                if (trilinear(grid, phi, position) > outside)
                    lone[c].push_back({node, position, particles.volume[at]});
            }
        }
    std::vector<LoneParticle> all;
    for (const auto& of_chunk : lone)
        all.insert(all.end(), of_chunk.begin(), of_chunk.end());
    return all;
}

/// Particles that stand outside the smoothed surface become balls, united with the rest.
void unite_lone_particles(const Grid& grid, const Particles& particles, const LevelSetOptions& options,
                          Field& phi) {
    for (const LoneParticle& particle : lone_particles(grid, particles, phi)) {
        const double radius = (options.radius - 0.5) * std::cbrt(particle.volume);
        const auto low = [&](int axis) { return std::max<std::int64_t>(0, particle.node[axis] - 4); };
        const auto high = [&](int axis) {
            return std::min<std::int64_t>(grid.cells[axis], particle.node[axis] + 4);
        };
        for (std::int64_t k = low(2); k <= high(2); ++k)
            for (std::int64_t j = low(1); j <= high(1); ++j)
                for (std::int64_t i = low(0); i <= high(0); ++i) {
                    double& value = phi[grid.index(i, j, k)];
                    value = std::min(value, (grid.position(i, j, k) - particle.position).norm() - radius);
                }
    }
}

} // namespace

double distance_of_fraction(double fraction) {
    // The half space x < 0 smoothed by N has the fraction C(-x), C(u) = integral of N up to u.
    if (fraction > 0.5)
        return -distance_of_fraction(1.0 - fraction);
    if (fraction <= 0.0)
        return beyond_smoothing;
    if (fraction <= 1.0 / 6.0) // C(u) = (3/2 + u)^3 / 6 for u <= -1/2
        return 1.5 - std::cbrt(6.0 * fraction);
    double x = (0.5 - fraction) / 0.75; // 1 - C(x) = 1/2 - 3/4 x + x^3/3 for |x| <= 1/2
    for (int i = 0; i < 5; ++i)
        x -= (0.5 - fraction - 0.75 * x + x * x * x / 3.0) / (-0.75 + x * x);
    return x;
}

Field signed_distance(const Grid& grid, const Particles& particles, const LevelSetOptions& options) {
    const Field smoothed = smoothed_distance(grid, particles);
    std::vector<std::int32_t> nearest;
    const std::vector<Foot> feet = find_feet(grid, smoothed, nearest);
    const double far = level_set_band * grid.dx;
    const NodeBand band = sweep_feet(grid, feet, far + 0.5 * grid.dx, nearest);

    Field phi(grid.size, 0.0);
    for_each_tile(grid, [&](std::int64_t first, std::int64_t end, std::int64_t j, std::int64_t k) {
        for (std::int64_t at = grid.index(first, j, k); at < grid.index(end, j, k); ++at)
            phi[at] = smoothed[at] < 0.0 ? -far : far;
    });
    band.for_each_node(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at) {
        if (nearest[at] >= 0)
            phi[at] = std::copysign(
                std::min(far, distance_near(grid, smoothed, grid.position(i, j, k), feet[nearest[at]])),
                phi[at]);
    });
    undo_shift_by_curvature(grid, band, phi);
    unite_lone_particles(grid, particles, options, phi);
    mirror_ghosts(grid, Boundary{}, phi);
    return phi;
}

Field regularized(const Grid& grid, const Field& phi, const LevelSetOptions& options) {
    const double epsilon = options.epsilon * grid.dx;
    const auto profile = [&](double distance) { return 0.5 - 1.0 / (1.0 + std::exp(distance / epsilon)); };
    // Most nodes are far from the surface, where phi has one of two values.
    const double far = level_set_band * grid.dx, inside = profile(-far), outside = profile(far);
    Field phi_hat(grid.size, 0.0);
#pragma omp parallel for schedule(static)
    for (std::int64_t first = 0; first < grid.size; first += lane_count) { // rows are whole cache lines
        const Lanes distance = load(&phi[first]);
        if (all_of(distance == -far)) {
            store(Lanes(inside), &phi_hat[first]);
        } else if (all_of(distance == far)) {
            store(Lanes(outside), &phi_hat[first]);
        } else {
            for (std::int64_t at = first; at < first + lane_count; ++at)
                phi_hat[at] = phi[at] == -far ? inside : phi[at] == far ? outside : profile(phi[at]);
        }
    }
    return phi_hat;
}

} // namespace meltscope
