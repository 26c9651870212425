#include "quiescence.hpp"

#include "meltscope/beam/profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace meltscope {
namespace {

/// Bins along each axis on either side of a point's that share nodes with the stencil of that point.
constexpr std::int64_t bins_around = 2;

/// In cells: from an element to the furthest node that takes its heat (its particle may be two cells off, the
/// node two further along each axis), and how much further that gets within the step (see restless_bricks).
constexpr double element_reach = 6.0, spread = 6.0;

double lowest_solidus(const Simulation& s) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const EquationOfState& eos : s.eos)
        lowest = std::min(lowest, eos.solidus);
    return lowest;
}

Vec3 centre(const Simulation& s, std::int64_t brick) {
    const Index3& count = s.quiescence.bricks.count;
    const Index3 at(brick % count[0], brick / count[0] % count[1], brick / count[0] / count[1]);
    Vec3 cells;
    for (int axis = 0; axis < 3; ++axis)
        cells[axis] = double(bins_in_brick[axis] * at[axis]) + 0.5 * double(bins_in_brick[axis] - 1);
    return s.grid.origin + s.grid.dx * cells;
}

double half_diagonal(const Simulation& s) {
    const auto& n = bins_in_brick;
    return 0.5 * s.grid.dx * std::sqrt(double(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]));
}

/// Bricks that share nodes with the stencils of points in the bins from `low` to `high`.
std::vector<std::int64_t> bricks_around(const Simulation& s, const Index3& low, const Index3& high) {
    return bricks_of_bins(s.quiescence.bricks, low - bins_around, high + bins_around);
}

/// The same for the bins of a lane group, or more of them where lanes are few: any width gives the same.
std::vector<std::int64_t> bricks_around(const Simulation& s, const LaneGroup& group) {
    const Grid& grid = s.grid;
    // The corner is one node below the first bin, and storage starts one node below the box.
    Index3 low(group.corner % grid.stride_y, group.corner % grid.stride_z / grid.stride_y,
               group.corner / grid.stride_z);
    low[0] -= low[0] % bins_in_brick[0];
    return bricks_around(s, low, low + Index3(bins_in_brick[0] - 1, 0, 0));
}

/// Bricks that share nodes with the stencils of surface elements, and those beside them.
std::vector<char> bricks_at_surface(const Simulation& s) {
    std::vector<char> at_surface(s.quiescence.bricks.awake.size(), 0);
    for (const LaneGroup& group : s.surface.elements.layout.groups)
        for (const std::int64_t brick : bricks_around(s, group))
            at_surface[brick] = 1;
    return with_neighbours(s.quiescence.bricks, at_surface);
}

/// Does the light or the heat of a laser reach it during the step?
bool is_lit(const Simulation& s, const Laser& laser, const BeamPosition& beam, std::int64_t brick) {
    const Vec3 at = centre(s, brick);
    if (laser.profile == BeamProfile::volumetric) {
        const VolumeSource source = volume_source(laser, beam);
        const double reach = source.cutoff * std::max({source.a, source.b, source.c});
        return (at - source.origin).norm() <= reach + half_diagonal(s) + spread * s.grid.dx;
    }
    return s.quiescence.at_surface[brick] &&
           std::sqrt(axis_distance_squared(at, beam.position, laser.direction.normalized())) <=
               cutoff_radius(laser) + half_diagonal(s) + (element_reach + spread) * s.grid.dx;
}

void add_lit(const Simulation& s, double dt, std::vector<std::int64_t>& which) {
    for (const Laser& laser : s.parameters.lasers) {
        double power = 0.0;
        const BeamPosition beam = beam_now(laser, s.time + 0.5 * dt, power);
        if (power <= 0.0)
            continue;
        for (std::int64_t brick = 0; brick < std::int64_t(s.quiescence.bricks.awake.size()); ++brick)
            if (s.quiescence.bricks.sleeps(brick) && is_lit(s, laser, beam, brick))
                which.push_back(brick);
    }
}

/// Those that lose heat through the free surface. Radiation from elsewhere reaches every surface.
void add_losing(const Simulation& s, std::vector<std::int64_t>& which) {
    if (s.loss_laws.empty())
        return;
    const double ambient = s.parameters.physics.ambient;
    const double tolerance = s.parameters.physics.quiescent_tolerance;
    for (std::int64_t brick = 0; brick < std::int64_t(s.quiescence.bricks.awake.size()); ++brick)
        if (s.quiescence.bricks.sleeps(brick) && s.quiescence.at_surface[brick] &&
            (s.exchange || s.quiescence.bricks.hottest[brick] - ambient > tolerance ||
             ambient - s.quiescence.bricks.coldest[brick] > tolerance))
            which.push_back(brick);
}

void add_restless(const Simulation& s, std::span<const std::int64_t> candidates,
                  std::vector<std::int64_t>& which) {
    const auto restless =
        restless_bricks(s.grid, s.parameters.boundary, s.quiescence.bricks, s.nodes,
                        s.parameters.physics.quiescent_tolerance, lowest_solidus(s), candidates);
    which.insert(which.end(), restless.begin(), restless.end());
}

} // namespace

void find_elements_awake(Simulation& s) {
    if (s.loss_laws.empty() || s.quiescence.bricks.awake.empty())
        return;
    const auto& groups = s.surface.elements.layout.groups;
    s.loss_elements.awake.resize(groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const auto around = bricks_around(s, groups[g]);
        s.loss_elements.awake[g] = std::none_of(around.begin(), around.end(), [&](std::int64_t brick) {
            return s.quiescence.bricks.sleeps(brick);
        });
    }
}

namespace {

/// With nobody asleep the step is the plain one again.
void forget_if_all_awake(Simulation& s) {
    if (!sleeping_bricks(s.quiescence.bricks).empty())
        return;
    s.quiescence = {};
    s.loss_elements.awake.clear();
    s.particles.awake = all_groups(s.particles.layout);
    s.nodes.spans = all_nodes(s.grid);
}

void wake_some(Simulation& s, std::span<const std::int64_t> which) {
    if (which.empty())
        return;
    wake(s.grid, s.parameters.boundary, s.eos, which, s.quiescence.bricks, s.particles, s.nodes);
    find_elements_awake(s);
    forget_if_all_awake(s);
}

void begin_bricks(Simulation& s) {
    s.quiescence = {};
    s.quiescence.bricks = make_bricks(s.grid, s.particles, s.eos);
    s.quiescence.mass_of_all = s.nodes.mass; // nobody sleeps yet
    s.quiescence.at_surface = bricks_at_surface(s);
}

} // namespace

void fall_asleep(Simulation& s) {
    if (s.parameters.physics.quiescent_tolerance <= 0.0)
        return;
    begin_bricks(s);
    std::vector<std::int64_t> restless;
    add_losing(s, restless);
    add_restless(s, sleeping_bricks(s.quiescence.bricks), restless);
    put_to_sleep(s.grid, s.parameters.boundary, s.quiescence.bricks, s.particles, s.nodes);
    find_elements_awake(s);
    wake_some(s, restless);
}

void go_on_asleep(Simulation& s, std::vector<char> awake) {
    s.quiescence = {};
    if (awake.empty())
        return;
    begin_bricks(s);
    s.quiescence.bricks.awake = std::move(awake);
    put_to_sleep(s.grid, s.parameters.boundary, s.quiescence.bricks, s.particles, s.nodes);
    find_elements_awake(s);
}

void wake_for_step(Simulation& s, double dt) {
    Quiescence& quiescence = s.quiescence;
    if (quiescence.bricks.awake.empty())
        return;
    const double tolerance = s.parameters.physics.quiescent_tolerance;
    std::vector<std::int64_t> which;
    if (tolerance <= 0.0) {
        which = sleeping_bricks(quiescence.bricks);
    } else if (quiescence.looked_with != tolerance) {
        add_restless(s, sleeping_bricks(quiescence.bricks), which);
        add_losing(s, which);
    } else {
        add_restless(s, quiescence.bricks.border, which);
    }
    quiescence.looked_with = tolerance;
    add_lit(s, dt, which);
    wake_some(s, which);
}

std::vector<char> wake_around(Simulation& s, const std::vector<Vec3>& points) {
    if (s.quiescence.bricks.awake.empty())
        return {};
    // One brick further than what shares nodes with them: it will share nodes with that.
    const Index3 further(bins_in_brick[0], bins_in_brick[1], bins_in_brick[2]);
    std::vector<char> chosen(s.quiescence.bricks.awake.size(), 0);
    for (const Vec3& point : points) {
        const auto node = bin_place(s.grid, point).node;
        const Index3 bin(node[0], node[1], node[2]);
        for (const std::int64_t brick : bricks_around(s, bin - further, bin + further))
            chosen[brick] = 1;
    }
    std::vector<std::int64_t> which;
    for (std::size_t brick = 0; brick < chosen.size(); ++brick)
        if (chosen[brick])
            which.push_back(std::int64_t(brick));
    wake_some(s, which);
    std::vector<char> awake = s.quiescence.bricks.awake;
    for (std::size_t brick = 0; brick < awake.size(); ++brick)
        awake[brick] |= chosen[brick];
    return awake;
}

} // namespace meltscope
