#include "meltscope/beam/volume_heating.hpp"

#include "meltscope/beam/profile.hpp"
#include "meltscope/mpm/group_stencils.hpp"

#include "footprint.hpp"

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

/// A lane group that the source reaches, and where its powers start in the list of them.
struct ReachedGroup {
    std::int64_t group;
    std::int64_t first_power;
};

/// The reached groups of a block.
struct ReachedBlock {
    int colour;
    std::int64_t first, last; ///< in the list of reached groups
};

struct Reached {
    std::vector<ReachedGroup> groups;
    std::vector<ReachedBlock> blocks; ///< sorted by colour
    Field power;                      ///< W, before scaling, one an entry of the groups' slots
};

/// Place in m of the node that lane 0's bin of the group is centred on.
Vec3 bin_node(const Grid& grid, const LaneGroup& group) {
    const std::int64_t k = group.corner / grid.stride_z;
    const std::int64_t j = group.corner % grid.stride_z / grid.stride_y;
    const std::int64_t i = group.corner % grid.stride_y;
    return grid.position(i, j, k); // the corner is one node lower, and storage starts one node lower
}

/// Distance in m, squared, of a point from the bins of a group.
double distance_squared(const Grid& grid, const LaneGroup& group, const Vec3& point) {
    const Vec3 low = bin_node(grid, group) - Vec3::Constant(0.5 * grid.dx);
    const Vec3 high = low + grid.dx * Vec3(lane_count, 1.0, 1.0);
    return (point - point.cwiseMax(low).cwiseMin(high)).squaredNorm();
}

Reached find_reached(const Grid& grid, const Particles& particles, const VolumeSource& source) {
    const double reach = source.cutoff * std::max({source.a, source.b, source.c});
    Reached reached;
    std::int64_t entries = 0;
    for (int colour = 0; colour < 4; ++colour)
        for (std::int64_t b = particles.layout.colour_start[colour];
             b < particles.layout.colour_start[colour + 1]; ++b) {
            const std::int64_t before = std::int64_t(reached.groups.size());
            for (std::int64_t g = particles.layout.blocks[b].first_group;
                 g < particles.layout.blocks[b].last_group; ++g) {
                const LaneGroup& group = particles.layout.groups[g];
                if (distance_squared(grid, group, source.origin) > reach * reach)
                    continue;
                reached.groups.push_back({g, entries});
                entries += group.slots * lane_count;
            }
            if (std::int64_t(reached.groups.size()) > before)
                reached.blocks.push_back({colour, before, std::int64_t(reached.groups.size())});
        }
    reached.power.assign(entries, 0.0);
    return reached;
}

/// S_p v_p of the reached particles.
void find_powers(const Grid& grid, const Particles& particles, const VolumeSource& source, double power,
                 Reached& reached) {
#pragma omp parallel for schedule(static)
    for (std::size_t r = 0; r < reached.groups.size(); ++r) {
        const LaneGroup& group = particles.layout.groups[reached.groups[r].group];
        const Vec3 node = bin_node(grid, group);
        for (std::int64_t entry = 0; entry < group.slots * lane_count; ++entry) {
            const std::int64_t at = group.first_slot * lane_count + entry;
            if (particles.volume[at] == 0.0)
                continue;
            const Vec3 offset =
                offset_in_bin(particles, group, at) + Vec3(double(entry % lane_count), 0.0, 0.0);
            reached.power[reached.groups[r].first_power + entry] =
                power_density(source, power, node + grid.dx * offset) * particles.volume[at];
        }
    }
}

/// D_i += factor sum_p N_ip power_p.
void scatter(const Grid& grid, const Particles& particles, const Reached& reached, double factor,
             Field& field) {
    const LatticeStencils lattices;
    const auto scatter_block = [&](const ReachedBlock& block) {
        for (std::int64_t r = block.first; r < block.last; ++r) {
            const LaneGroup& group = particles.layout.groups[reached.groups[r].group];
            const double* power = &reached.power[reached.groups[r].first_power];
            NodeSums sums;
            for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
                std::array<Lanes, std::decay_t<decltype(stencil)>::points> joule;
                const double* from = power + (first - group.first_slot * lane_count);
                for (std::size_t p = 0; p < joule.size(); ++p)
                    joule[p] = factor * load(from + p * lane_count);
                stencil.scatter_value(joule, sums);
            });
            sums.add_to(field.data(), group.corner, grid.stride_y, grid.stride_z);
        }
    };
    // Blocks of one colour have no node in common.
    for (auto first = reached.blocks.begin(); first != reached.blocks.end();) {
        const auto last = std::find_if(first, reached.blocks.end(), [&](const ReachedBlock& block) {
            return block.colour != first->colour;
        });
        const std::int64_t count = last - first;
#pragma omp parallel for schedule(dynamic, 1)
        for (std::int64_t n = 0; n < count; ++n)
            scatter_block(first[n]);
        first = last;
    }
}

} // namespace

Absorption deposit_volume(const Grid& grid, const Particles& particles, const LightMap& map,
                          const Laser& laser, const BeamPosition& beam, double power, double dt,
                          Nodes& nodes) {
    Absorption result;
    if (power <= 0.0)
        return result;
    const VolumeSource source = volume_source(laser, beam);
    const double share = share_that_meets_material(
        map, source.origin, source.cutoff * std::max(source.a, source.b), [&](const Vec3& aside) {
            const double x = aside.dot(source.along) / source.a, y = aside.dot(source.across) / source.b;
            const double squared = x * x + y * y;
            return squared < source.cutoff * source.cutoff ? std::exp(-2.0 * squared) : 0.0;
        });
    Reached reached = find_reached(grid, particles, source);
    find_powers(grid, particles, source, laser.absorptivity * power, reached);
    double sum = 0.0;
    for (const double watt : reached.power)
        sum += watt;
    if (sum <= 0.0 || share <= 0.0)
        return {0.0, power, 1.0};
    result.missed = power * (1.0 - share);
    result.absorbed = laser.absorptivity * power * share;
    result.scale = result.absorbed / sum;
    scatter(grid, particles, reached, result.scale * dt, nodes.increment);
    return result;
}

} // namespace meltscope
