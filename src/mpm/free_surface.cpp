#include "meltscope/mpm/free_surface.hpp"

#include "tile_flags.hpp"

#include "meltscope/mpm/group_stencils.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace meltscope {
namespace {

/// phi_hat at a particle lies between those of the 27 nodes around it: a group is left out if they all are
/// beyond the gate on one side.
SurfaceAreas find_surface_groups(const Grid& grid, const Particles& particles, const Field& phi_hat) {
    constexpr unsigned char inward = 1, outward = 2, both = inward | outward; // has nodes this side of a gate
    TileFlags sides(grid);
    sides.set(grid, [&](std::int64_t i, std::int64_t end, std::int64_t j, std::int64_t k) {
        unsigned char flags = 0;
        if (end - i == lane_count) {
            const Lanes value = load(&phi_hat[grid.index(i, j, k)]);
            flags |= any_of(value <= surface_gate) ? inward : 0;
            flags |= any_of(value >= -surface_gate) ? outward : 0;
            return flags;
        }
        for (std::int64_t at = grid.index(i, j, k); at < grid.index(end, j, k); ++at) {
            flags |= phi_hat[at] <= surface_gate ? inward : 0;
            flags |= phi_hat[at] >= -surface_gate ? outward : 0;
        }
        return flags;
    });
    sides.widen();

    const auto& groups = particles.layout.groups;
    SurfaceAreas near;
    near.first.assign(groups.size(), -1);
#pragma omp parallel for schedule(static)
    for (std::size_t g = 0; g < groups.size(); ++g) {
        if (sides[sides.tile_of(groups[g])] != both)
            continue;
        const LaneRange around = range_around(grid, phi_hat, groups[g]); // the same of each bin by itself
        if (any_of(around.least <= surface_gate && around.most >= -surface_gate))
            near.first[g] = 0;
    }
    std::int64_t entries = 0;
    for (std::size_t g = 0; g < groups.size(); ++g)
        if (near.first[g] == 0) {
            near.group.push_back(std::int64_t(g));
            near.first[g] = entries;
            entries += groups[g].slots * lane_count;
        }
    near.area.assign(entries, 0.0);
    return near;
}

/// Calls work(stencil, group, first_entry, shift) for each stencil of the surface groups, threads sharing the
/// groups: entry `at` of the per-particle arrays is entry at + shift here.
template <class Work>
void for_each_surface_stencil(const Particles& particles, const SurfaceAreas& near, Work work) {
    const LatticeStencils lattices;
#pragma omp parallel for schedule(static)
    for (std::size_t n = 0; n < near.group.size(); ++n) {
        const LaneGroup& group = particles.layout.groups[near.group[n]];
        const std::int64_t shift = near.first[near.group[n]] - group.first_slot * lane_count;
        for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
            work(stencil, group, first, shift);
        });
    }
}

/// The areas become s_p in m^2, zero beyond the gate.
void set_weights(const Grid& grid, const Particles& particles, const Field& phi_hat, SurfaceAreas& near) {
    for_each_surface_stencil(
        particles, near,
        [&](const auto& stencil, const LaneGroup& group, std::int64_t first, std::int64_t shift) {
            using Stencil = std::decay_t<decltype(stencil)>;
            typename Stencil::Points f;
            stencil.gather(phi_hat.data() + group.corner, grid.stride_y, grid.stride_z, f);
            for (int p = 0; p < Stencil::points; ++p) {
                const std::int64_t entry = first + p * lane_count;
                const Lanes slope = sqrt(f.x[p] * f.x[p] + f.y[p] * f.y[p] + f.z[p] * f.z[p]) / grid.dx;
                store(select(abs(f.value[p]) <= surface_gate, slope * load(&particles.volume[entry]),
                             Lanes(0.0)),
                      &near.area[entry + shift]);
            }
        });
}

/// sum_q N_iq s_q
Field sum_at_nodes(const Grid& grid, const Particles& particles, const SurfaceAreas& near) {
    Field total(grid.size, 0.0);
    const LatticeStencils lattices;
    for_each_block(particles.layout, [&](const LaneBlock& block) {
        for (std::int64_t g = block.first_group; g < block.last_group; ++g) {
            if (near.first[g] < 0)
                continue;
            const LaneGroup& group = particles.layout.groups[g];
            const std::int64_t shift = near.first[g] - group.first_slot * lane_count;
            NodeSums sums;
            for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
                std::array<Lanes, std::decay_t<decltype(stencil)>::points> s;
                for (std::size_t p = 0; p < s.size(); ++p)
                    s[p] = load(&near.area[first + p * lane_count + shift]);
                stencil.scatter_value(s, sums);
            });
            sums.add_to(total.data(), group.corner, grid.stride_y, grid.stride_z);
        }
    });
    fold_ghosts(grid, Boundary{}, AtFixedFaces::leave, total);
    return total;
}

/// Turns s_p into a_p = s_p sum_i N_ip A_i / sum_q N_iq s_q, m^2.
void share_out_areas(const Grid& grid, const Particles& particles, const Field& area_by_weight,
                     SurfaceAreas& near) {
    for_each_surface_stencil(
        particles, near,
        [&](const auto& stencil, const LaneGroup& group, std::int64_t first, std::int64_t shift) {
            std::array<Lanes, std::decay_t<decltype(stencil)>::points> share;
            stencil.gather(area_by_weight.data() + group.corner, grid.stride_y, grid.stride_z, share);
            for (std::size_t p = 0; p < share.size(); ++p) {
                const std::int64_t entry = first + std::int64_t(p) * lane_count + shift;
                store(share[p] * load(&near.area[entry]), &near.area[entry]);
            }
        });
}

/// The particles that have an area, one by one in the order of their ids, and their entries.
struct Chosen {
    std::vector<std::int64_t> particle, entry;
};

Chosen choose_particles(const Particles& particles, const SurfaceAreas& near) {
    std::vector<std::int64_t> shift(particles.layout.slots, -1); // of each slot: its first entry
    std::vector<bool> looked_at(particles.layout.slots); // most particles end here, in memory that stays near
    for (const std::int64_t g : near.group) {
        const LaneGroup& group = particles.layout.groups[g];
        for (std::int64_t slot = 0; slot < group.slots; ++slot) {
            shift[group.first_slot + slot] = near.first[g] + slot * lane_count;
            looked_at[group.first_slot + slot] = true;
        }
    }
    // Twice over chunks of the particles, how many each has and then which: lists that grow take more memory.
    constexpr std::int64_t chunk = 1 << 14;
    const std::int64_t chunks = (particles.count() + chunk - 1) / chunk;
    const auto for_each_chosen = [&](std::int64_t c, auto work) {
        for (std::int64_t q = c * chunk; q < std::min(particles.count(), (c + 1) * chunk); ++q) {
            const std::int64_t place = particles.layout.place[q], slot = place / lane_count;
            if (!looked_at[slot])
                continue;
            const std::int64_t entry = shift[slot] + place % lane_count;
            if (near.area[entry] > 0.0)
                work(q, entry);
        }
    };
    std::vector<std::int64_t> start(chunks + 1, 0);
#pragma omp parallel for schedule(dynamic, 1)
    for (std::int64_t c = 0; c < chunks; ++c)
        for_each_chosen(c, [&](std::int64_t, std::int64_t) { ++start[c + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    Chosen all{std::vector<std::int64_t>(start.back()), std::vector<std::int64_t>(start.back())};
#pragma omp parallel for schedule(dynamic, 1)
    for (std::int64_t c = 0; c < chunks; ++c) {
        std::int64_t n = start[c];
        if (n < start[c + 1])
            for_each_chosen(c, [&](std::int64_t particle, std::int64_t entry) {
                all.particle[n] = particle;
                all.entry[n++] = entry;
            });
    }
    return all;
}

/// Foot points and normals of the chosen particles.
void find_feet(const Grid& grid, const Particles& particles, const SurfaceAreas& near, const Field& phi,
               const Field& phi_hat, const std::vector<std::int64_t>& entries, SurfaceElements& elements) {
    std::vector<std::int64_t> element_at(near.area.size(), -1);
#pragma omp parallel for schedule(static)
    for (std::size_t s = 0; s < entries.size(); ++s)
        element_at[entries[s]] = std::int64_t(s);
    elements.point.resize(entries.size());
    elements.normal.resize(entries.size());
    for_each_surface_stencil(
        particles, near,
        [&](const auto& stencil, const LaneGroup& group, std::int64_t first, std::int64_t shift) {
            using Stencil = std::decay_t<decltype(stencil)>;
            typename Stencil::Points f;
            stencil.gather(phi_hat.data() + group.corner, grid.stride_y, grid.stride_z, f);
            std::array<Lanes, Stencil::points> distance;
            stencil.gather(phi.data() + group.corner, grid.stride_y, grid.stride_z, distance);
            for (int p = 0; p < Stencil::points; ++p)
                for (int lane = 0; lane < lane_count; ++lane) {
                    const std::int64_t s = element_at[first + p * lane_count + lane + shift];
                    if (s < 0)
                        continue;
                    const Vec3 normal = Vec3(f.x[p][lane], f.y[p][lane], f.z[p][lane]).normalized();
                    elements.normal[s] = normal;
                    elements.point[s] =
                        (particles.position[elements.particle[s]] - double(distance[p][lane]) * normal)
                            .cwiseMax(grid.origin)
                            .cwiseMin(grid.upper_corner());
                }
        });
}

/// A_i = dx^3 |grad phi_i| hat(phi_i), the box's share of the node's cell. The hat is (|n_x| + |n_y| + |n_z|)
/// dx wide to either side, so that its sum over the nodes is that of a plane of any tilt: B. Engquist, A.-K.
/// Tornberg, R. Tsai, J. Comput. Phys. 207 (2005) 28.
double node_area(const Grid& grid, const Field& phi, std::int64_t i, std::int64_t j, std::int64_t k) {
    const double dx = grid.dx;
    const std::int64_t at = grid.index(i, j, k);
    if (std::abs(phi[at]) >= std::sqrt(3.0) * dx)
        return 0.0;
    const Vec3 gradient = Vec3(phi[at + 1] - phi[at - 1], phi[at + grid.stride_y] - phi[at - grid.stride_y],
                               phi[at + grid.stride_z] - phi[at - grid.stride_z]) /
                          (2.0 * dx);
    const double slope = gradient.norm();
    if (slope == 0.0)
        return 0.0;
    const double width = dx * gradient.lpNorm<1>() / slope;
    const double hat = std::max(0.0, 1.0 - std::abs(phi[at]) / width) / width;
    return dx * dx * dx * grid.share_in_box(i, j, k) * slope * hat;
}

/// Turns sum_q N_iq s_q into A_i / sum_q N_iq s_q.
void divide_areas_by(const Grid& grid, const Field& phi, Field& total) {
    for_each_tile(grid, [&](std::int64_t first, std::int64_t end, std::int64_t j, std::int64_t k) {
        double* row = &total[grid.index(0, j, k)];
        if (all_of(load(row + first) == 0.0))
            return;
        for (std::int64_t i = first; i < end; ++i)
            if (row[i] > 0.0)
                row[i] = node_area(grid, phi, i, j, k) / row[i];
    });
    mirror_ghosts(grid, Boundary{}, total);
}

/// The particles of the surface with their foot points, normals and areas.
void list_elements(const Grid& grid, const Particles& particles, const Field& phi, const Field& phi_hat,
                   const SurfaceAreas& near, SurfaceElements& elements) {
    Chosen chosen = choose_particles(particles, near);
    elements.particle = std::move(chosen.particle);
    elements.area.resize(chosen.entry.size());
    for (std::size_t s = 0; s < chosen.entry.size(); ++s)
        elements.area[s] = near.area[chosen.entry[s]];
    find_feet(grid, particles, near, phi, phi_hat, chosen.entry, elements);
}

/// Lays out the points where the heat goes in and finds their weights' normalization.
void lay_out(const Grid& grid, const Particles& particles, const Nodes& nodes, std::span<const Vec3> points,
             SurfaceElements& elements) {
    std::vector<std::int16_t> material(points.size());
#pragma omp parallel for schedule(static)
    for (std::size_t s = 0; s < points.size(); ++s)
        material[s] = particles.material[elements.particle[s]];
    elements.layout = make_lane_layout(grid, points, material, 0);
    for (Field* field : {&elements.offset_x, &elements.offset_y, &elements.offset_z, &elements.normalization})
        field->assign(elements.layout.size(), 0.0);
#pragma omp parallel for schedule(static)
    for (std::size_t s = 0; s < points.size(); ++s) {
        const BinPlace bin = bin_place(grid, points[s]);
        const std::int64_t at = elements.layout.place[s];
        elements.offset_x[at] = bin.offset[0];
        elements.offset_y[at] = bin.offset[1];
        elements.offset_z[at] = bin.offset[2];
        elements.normalization[at] = 1.0;
    }
    Field present(grid.size, 0.0);
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < grid.size; ++i)
        present[i] = nodes.mass[i] > 0.0 ? 1.0 : 0.0;
    // Beyond faces of fixed temperature ghosts have a mass of their own.
    mirror_ghosts(grid, nodes.boundary, present);
#pragma omp parallel for schedule(static)
    for (std::size_t g = 0; g < elements.layout.groups.size(); ++g) {
        const LaneGroup& group = elements.layout.groups[g];
        for (std::int64_t slot = group.first_slot; slot < group.first_slot + group.slots; ++slot) {
            std::array<Lanes, 1> sum;
            point_stencil(elements.offset_x.data(), elements.offset_y.data(), elements.offset_z.data(), slot)
                .gather(present.data() + group.corner, grid.stride_y, grid.stride_z, sum);
            double* normalization = &elements.normalization[slot * lane_count];
            const Lanes counts = load(normalization); // 0: padding
            store(select(counts > 0.0, counts / select(counts > 0.0, sum[0], Lanes(1.0)), Lanes(0.0)),
                  normalization);
        }
    }
}

} // namespace

SurfaceAreas find_surface_areas(const Grid& grid, const Particles& particles, const Field& phi,
                                const Field& phi_hat) {
    SurfaceAreas near = find_surface_groups(grid, particles, phi_hat);
    set_weights(grid, particles, phi_hat, near);
    Field nodal = sum_at_nodes(grid, particles, near);
    divide_areas_by(grid, phi, nodal);
    share_out_areas(grid, particles, nodal, near);
    return near;
}

FreeSurface find_free_surface(const Grid& grid, const Particles& particles, const Nodes& nodes,
                              const LevelSetOptions& options, bool at_surface) {
    FreeSurface surface;
    surface.phi = signed_distance(grid, particles, options);
    SurfaceElements& elements = surface.elements;
    {
        const Field phi_hat = regularized(grid, surface.phi, options);
        list_elements(grid, particles, surface.phi, phi_hat,
                      find_surface_areas(grid, particles, surface.phi, phi_hat), elements);
    }
    if (at_surface) {
        lay_out(grid, particles, nodes, elements.point, elements);
        return surface;
    }
    std::vector<Vec3> places(elements.particle.size());
    for (std::size_t s = 0; s < places.size(); ++s)
        places[s] = particles.position[elements.particle[s]];
    lay_out(grid, particles, nodes, places, elements);
    return surface;
}

} // namespace meltscope
