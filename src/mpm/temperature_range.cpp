#include "meltscope/mpm/temperature_range.hpp"

#include "meltscope/mpm/group_stencils.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope {
namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// Whole kelvins begin at 0.37, so that round-off of a plate at a round temperature does not straddle two.
constexpr double kelvin_begins = 0.37;

struct Bounds {
    double low = unbounded, high = -unbounded;

    void include(const Bounds& other) {
        low = std::min(low, other.low);
        high = std::max(high, other.high);
    }
};

/// Bounds of the node temperatures around a group; nodes without one (zero) are left out. Adds to `sum`, of
/// absolute values, from which what is not a number does not go away as it does from comparisons. The middle
/// nodes along x suffice: a particle with such an energy has spread it to all of its nodes.
Bounds node_bounds(const Grid& grid, const LaneGroup& group, const double* temperature, Lanes& sum) {
    Lanes low(unbounded), high(-unbounded);
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) {
                const Lanes t = load(temperature + group.corner + i + j * grid.stride_y + k * grid.stride_z);
                low = min(low, select(t == 0.0, Lanes(unbounded), t));
                high = max(high, select(t == 0.0, Lanes(-unbounded), t));
                if (i == 1)
                    sum += abs(t);
            }
    return {hmin(low), hmax(high)};
}

Bounds particle_bounds(const Grid& grid, const Particles& particles, const LatticeStencils& lattices,
                       const LaneGroup& group, const double* temperature) {
    Lanes low(unbounded), high(-unbounded);
    for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
        std::array<Lanes, std::decay_t<decltype(stencil)>::points> t;
        stencil.gather(temperature + group.corner, grid.stride_y, grid.stride_z, t);
        for (std::size_t p = 0; p < t.size(); ++p) {
            const auto padding = load(&particles.mass[first + p * lane_count]) == 0.0;
            low = min(low, select(padding, Lanes(unbounded), t[p]));
            high = max(high, select(padding, Lanes(-unbounded), t[p]));
        }
    });
    return {hmin(low), hmax(high)};
}

} // namespace

double down_to_whole_kelvin(double t) {
    return std::floor(t - kelvin_begins) + kelvin_begins;
}

double up_to_whole_kelvin(double t) {
    return std::ceil(t - kelvin_begins) + kelvin_begins;
}

TemperatureRange particle_temperature_range(const Grid& grid, const Particles& particles,
                                            const Nodes& nodes) {
    const LatticeStencils lattices;
    const double* temperature = nodes.temperature.data();
    Bounds all;
    bool all_finite = true;
#pragma omp parallel
    {
        // What a thread has seen says which groups it need not look into; the rounded range of all is the
        // same whichever thread saw what.
        Bounds seen;
        Lanes sum(0.0);
#pragma omp for schedule(dynamic, 1) nowait
        for (std::size_t r = 0; r < particles.awake.runs.size(); ++r)
            for (std::int64_t g = particles.awake.runs[r].first_group; g < particles.awake.runs[r].last_group;
                 ++g) {
                const LaneGroup& group = particles.layout.groups[g];
                const Bounds bounds = node_bounds(grid, group, temperature, sum);
                if (down_to_whole_kelvin(bounds.low) < seen.low ||
                    up_to_whole_kelvin(bounds.high) > seen.high) {
                    const Bounds exact = particle_bounds(grid, particles, lattices, group, temperature);
                    seen.include({down_to_whole_kelvin(exact.low), up_to_whole_kelvin(exact.high)});
                }
            }
#pragma omp critical
        {
            all.include(seen);
            all_finite = all_finite && std::isfinite(reduce(sum));
        }
    }
    return {all.low, all.high, all_finite};
}

} // namespace meltscope
