#include "meltscope/mpm/level_set.hpp"

#include "meltscope/mpm/boundary.hpp"
#include "meltscope/mpm/nodes.hpp"
#include "meltscope/mpm/trilinear.hpp"

#include <algorithm>
#include <cmath>

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

struct Foot {
    Vec3 point;  ///< m, on the surface
    Vec3 normal; ///< unit, out of the material
};

/// Walks over the nodes of the box.
template <class Work>
void for_each_node(const Grid& grid, Work work) {
#pragma omp parallel for schedule(static)
    for (std::int64_t k = 0; k <= grid.cells[2]; ++k)
        for (std::int64_t j = 0; j <= grid.cells[1]; ++j)
            for (std::int64_t i = 0; i <= grid.cells[0]; ++i)
                work(i, j, k, grid.index(i, j, k));
}

Vec3 central_difference(const Grid& grid, const Field& f, std::int64_t at) {
    return Vec3(f[at + 1] - f[at - 1], f[at + grid.stride_y] - f[at - grid.stride_y],
                f[at + grid.stride_z] - f[at - grid.stride_z]) /
           (2.0 * grid.dx);
}

/// Distance to the surface in cells as the smoothed volume fraction tells it; good within about one cell.
Field smoothed_distance(const Grid& grid, const Particles& particles) {
    Field fraction(grid.size, 0.0);
    scatter_to_nodes(grid, particles, particles.volume, fraction);
    fold_ghosts(grid, Boundary{}, AtFixedFaces::leave, fraction);
    const double cell = grid.dx * grid.dx * grid.dx;
    for_each_node(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at) {
        fraction[at] = distance_of_fraction(fraction[at] / (cell * grid.share_in_box(i, j, k)));
    });
    mirror_ghosts(grid, Boundary{}, fraction);
    return fraction;
}

/// Foot points of all nodes next to the surface, and the node-wise index of a node's own foot (-1: none).
std::vector<Foot> find_feet(const Grid& grid, const Field& distance, std::vector<std::int32_t>& nearest) {
    std::vector<std::vector<Foot>> feet_of_layer(grid.cells[2] + 1);
    nearest.assign(grid.size, -1);
#pragma omp parallel for schedule(dynamic, 1)
    for (std::int64_t k = 0; k <= grid.cells[2]; ++k)
        for (std::int64_t j = 0; j <= grid.cells[1]; ++j)
            for (std::int64_t i = 0; i <= grid.cells[0]; ++i) {
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
    std::vector<Foot> feet;
    for (std::int64_t k = 0; k <= grid.cells[2]; ++k) {
        const std::int32_t before = std::int32_t(feet.size());
        feet.insert(feet.end(), feet_of_layer[k].begin(), feet_of_layer[k].end());
        for (std::int64_t at = grid.index(0, 0, k); at <= grid.index(grid.cells[0], grid.cells[1], k); ++at)
            if (nearest[at] >= 0)
                nearest[at] += before;
    }
    return feet;
}

/// Hands the nearest foot from node to node along each axis, there and back, twice over.
class FootSweep {
  public:
    FootSweep(const Grid& grid, const std::vector<Foot>& feet, std::vector<std::int32_t>& nearest)
        : grid_(grid), feet_(feet), nearest_(nearest), squared_(grid.size, reach() * reach()) {
        for_each_node(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at) {
            if (nearest_[at] >= 0)
                squared_[at] = (grid.position(i, j, k) - feet_[nearest_[at]].point).squaredNorm();
        });
        for (int round = 0; round < 2; ++round)
            for (int axis = 0; axis < 3; ++axis)
                along(axis);
        all_around();
    }

  private:
    double reach() const { return (level_set_band + 0.5) * grid_.dx; }

    void along(int axis) {
        const std::array<std::int64_t, 3> stride{1, grid_.stride_y, grid_.stride_z};
        const int u = axis == 0 ? 1 : 0,
                  v = axis == 2 ? 1 : 2; // rows across the axis; u varies fastest in memory
        const std::int64_t last = grid_.cells[axis];
#pragma omp parallel for schedule(static)
        for (std::int64_t q = 0; q <= grid_.cells[v]; ++q) {
            const auto visit = [&](std::int64_t n, std::int64_t from) {
                for (std::int64_t p = 0; p <= grid_.cells[u]; ++p) {
                    Index3 node;
                    node[axis] = n;
                    node[u] = p;
                    node[v] = q;
                    const std::int64_t at = grid_.index(node[0], node[1], node[2]);
                    offer(node, at, nearest_[at + from * stride[axis]]);
                }
            };
            for (std::int64_t n = 1; n <= last; ++n)
                visit(n, -1);
            for (std::int64_t n = last - 1; n >= 0; --n)
                visit(n, 1);
        }
    }

    /// Every node looks at the feet of its 26 neighbours: what a row hands on along an axis can stop short of
    /// a node whose own foot lies askew.
    void all_around() {
        const std::vector<std::int32_t> before = nearest_;
        for_each_node(grid_, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at) {
            for (std::int64_t c = std::max<std::int64_t>(k - 1, 0); c <= std::min(k + 1, grid_.cells[2]); ++c)
                for (std::int64_t b = std::max<std::int64_t>(j - 1, 0); b <= std::min(j + 1, grid_.cells[1]);
                     ++b)
                    for (std::int64_t a = std::max<std::int64_t>(i - 1, 0);
                         a <= std::min(i + 1, grid_.cells[0]); ++a)
                        offer({i, j, k}, at, before[grid_.index(a, b, c)]);
        });
    }

    void offer(const Index3& node, std::int64_t at, std::int32_t foot) {
        if (foot < 0 || foot == nearest_[at])
            return;
        const double squared = (grid_.position(node[0], node[1], node[2]) - feet_[foot].point).squaredNorm();
        if (squared < squared_[at]) {
            squared_[at] = squared;
            nearest_[at] = foot;
        }
    }

    const Grid& grid_;
    const std::vector<Foot>& feet_;
    std::vector<std::int32_t>& nearest_;
    std::vector<double> squared_; // m^2
};

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
void undo_shift_by_curvature(const Grid& grid, Field& phi) {
    Field shift(grid.size, 0.0);
    const std::array<std::int64_t, 3> stride{1, grid.stride_y, grid.stride_z};
    for_each_node(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at) {
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
    for_each_node(grid,
                  [&](std::int64_t, std::int64_t, std::int64_t, std::int64_t at) { phi[at] -= shift[at]; });
}

/// Particles that stand outside the smoothed surface become balls, united with the rest.
void unite_lone_particles(const Grid& grid, const Particles& particles, const LevelSetOptions& options,
                          Field& phi) {
    std::vector<std::int64_t> lone;
    for (std::int64_t q = 0; q < particles.count(); ++q)
        if (trilinear(grid, phi, particles.position[q]) > smoothed_away * grid.dx)
            lone.push_back(q);
    for (const std::int64_t q : lone) {
        const Vec3& centre = particles.position[q];
        const double radius = (options.radius - 0.5) * std::cbrt(particles.volume[particles.layout.place[q]]);
        const BinPlace bin = bin_place(grid, centre);
        const auto low = [&](int axis) { return std::max<std::int64_t>(0, bin.node[axis] - 4); };
        const auto high = [&](int axis) {
            return std::min<std::int64_t>(grid.cells[axis], bin.node[axis] + 4);
        };
        for (std::int64_t k = low(2); k <= high(2); ++k)
            for (std::int64_t j = low(1); j <= high(1); ++j)
                for (std::int64_t i = low(0); i <= high(0); ++i) {
                    double& value = phi[grid.index(i, j, k)];
                    value = std::min(value, (grid.position(i, j, k) - centre).norm() - radius);
                }
    }
}

} // namespace

double distance_of_fraction(double fraction) {
    // The half space x < 0 smoothed by N has the fraction C(-x), C(u) = integral of N up to u.
    if (fraction > 0.5)
        return -distance_of_fraction(1.0 - fraction);
    if (fraction <= 0.0)
        return 1.5;
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
    FootSweep(grid, feet, nearest);

    Field phi(grid.size, 0.0);
    for_each_node(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t at) {
        const double sign = smoothed[at] < 0.0 ? -1.0 : 1.0;
        double distance = level_set_band * grid.dx;
        if (nearest[at] >= 0)
            distance =
                std::min(distance, distance_near(grid, smoothed, grid.position(i, j, k), feet[nearest[at]]));
        phi[at] = sign * distance;
    });
    undo_shift_by_curvature(grid, phi);
    unite_lone_particles(grid, particles, options, phi);
    mirror_ghosts(grid, Boundary{}, phi);
    return phi;
}

Field regularized(const Grid& grid, const Field& phi, const LevelSetOptions& options) {
    const double epsilon = options.epsilon * grid.dx;
    Field phi_hat(grid.size, 0.0);
#pragma omp parallel for schedule(static)
    for (std::int64_t at = 0; at < grid.size; ++at)
        phi_hat[at] = 0.5 - 1.0 / (1.0 + std::exp(phi[at] / epsilon));
    return phi_hat;
}

} // namespace meltscope
