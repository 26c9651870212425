#include "meltscope/mpm/free_surface.hpp"

#include "meltscope/mpm/group_stencils.hpp"

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

/// Lane groups that may hold particles of the surface, and their entries laid end to end: what is worked out
/// for these particles alone needs no array over all of them.
struct SurfaceGroups {
    std::vector<std::int64_t> group; ///< ascending
    std::vector<std::int64_t> first; ///< of each lane group of the layout: its first entry here, -1: none
    std::int64_t entries = 0;
};

/// phi_hat at a particle lies between those of the 27 nodes around it: a group is left out if they all are
/// beyond the gate on one side.
SurfaceGroups find_surface_groups(const Grid& grid, const Particles& particles, const Field& phi_hat) {
    const auto& groups = particles.layout.groups;
    SurfaceGroups near;
    near.first.assign(groups.size(), -1);
#pragma omp parallel for schedule(static)
    for (std::size_t g = 0; g < groups.size(); ++g) {
        Lanes least(1.0), most(-1.0);
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i) {
                    const Lanes value =
                        load(&phi_hat[groups[g].corner + i + j * grid.stride_y + k * grid.stride_z]);
                    least = min(least, value);
                    most = max(most, value);
                }
        if (any_of(least <= surface_gate && most >= -surface_gate))
            near.first[g] = 0;
    }
    for (std::size_t g = 0; g < groups.size(); ++g)
        if (near.first[g] == 0) {
            near.group.push_back(std::int64_t(g));
            near.first[g] = near.entries;
            near.entries += groups[g].slots * lane_count;
        }
    return near;
}

/// Calls work(stencil, group, first_entry, shift) for each stencil of the surface groups, threads sharing the
/// groups: entry `at` of the per-particle arrays is entry at + shift here.
template <class Work>
void for_each_surface_stencil(const Particles& particles, const SurfaceGroups& near, Work work) {
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

/// s_p in m^2 of the particles of the surface groups, entry by entry; zero beyond the gate.
Field surface_weights(const Grid& grid, const Particles& particles, const Field& phi_hat,
                      const SurfaceGroups& near) {
    Field weight(near.entries, 0.0);
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
                      &weight[entry + shift]);
            }
        });
    return weight;
}

/// sum_q N_iq s_q
Field sum_at_nodes(const Grid& grid, const Particles& particles, const SurfaceGroups& near,
                   const Field& weight) {
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
                    s[p] = load(&weight[first + p * lane_count + shift]);
                stencil.scatter_value(s, sums);
            });
            sums.add_to(total.data(), group.corner, grid.stride_y, grid.stride_z);
        }
    });
    fold_ghosts(grid, Boundary{}, AtFixedFaces::leave, total);
    return total;
}

/// Turns s_p into a_p = s_p sum_i N_ip A_i / sum_q N_iq s_q, m^2.
void share_out_areas(const Grid& grid, const Particles& particles, const SurfaceGroups& near,
                     const Field& area_by_weight, Field& weight) {
    for_each_surface_stencil(
        particles, near,
        [&](const auto& stencil, const LaneGroup& group, std::int64_t first, std::int64_t shift) {
            std::array<Lanes, std::decay_t<decltype(stencil)>::points> share;
            stencil.gather(area_by_weight.data() + group.corner, grid.stride_y, grid.stride_z, share);
            for (std::size_t p = 0; p < share.size(); ++p) {
                const std::int64_t entry = first + std::int64_t(p) * lane_count + shift;
                store(share[p] * load(&weight[entry]), &weight[entry]);
            }
        });
}

/// The particles that have an area, one by one in the order of their ids, and their entries.
struct Chosen {
    std::vector<std::int64_t> particle, entry;
};

Chosen choose_particles(const Particles& particles, const SurfaceGroups& near, const Field& area) {
    std::vector<std::int64_t> shift(particles.layout.slots, -1); // of each slot: its first entry
    for (const std::int64_t g : near.group) {
        const LaneGroup& group = particles.layout.groups[g];
        for (std::int64_t slot = 0; slot < group.slots; ++slot)
            shift[group.first_slot + slot] = near.first[g] + slot * lane_count;
    }
    constexpr std::int64_t chunk = 1 << 16;
    std::vector<Chosen> of_chunk((particles.count() + chunk - 1) / chunk);
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t c = 0; c < of_chunk.size(); ++c)
        for (std::int64_t q = std::int64_t(c) * chunk;
             q < std::min(particles.count(), std::int64_t(c + 1) * chunk); ++q) {
            const std::int64_t place = particles.layout.place[q];
            const std::int64_t first = shift[place / lane_count];
            if (first < 0 || !(area[first + place % lane_count] > 0.0))
                continue;
            of_chunk[c].particle.push_back(q);
            of_chunk[c].entry.push_back(first + place % lane_count);
        }
    Chosen all;
    for (const Chosen& some : of_chunk) {
        all.particle.insert(all.particle.end(), some.particle.begin(), some.particle.end());
        all.entry.insert(all.entry.end(), some.entry.begin(), some.entry.end());
    }
    return all;
}

/// Foot points and normals of the chosen particles.
void find_feet(const Grid& grid, const Particles& particles, const SurfaceGroups& near, const Field& phi,
               const Field& phi_hat, const std::vector<std::int64_t>& entries, SurfaceElements& elements) {
    std::vector<std::int64_t> element_at(near.entries, -1);
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
#pragma omp parallel for schedule(static)
    for (std::int64_t k = 0; k <= grid.cells[2]; ++k)
        for (std::int64_t j = 0; j <= grid.cells[1]; ++j)
            for (std::int64_t i = 0; i <= grid.cells[0]; ++i) {
                double& value = total[grid.index(i, j, k)];
                if (value > 0.0)
                    value = node_area(grid, phi, i, j, k) / value;
            }
    mirror_ghosts(grid, Boundary{}, total);
}

/// Lays out the points where the heat goes in and finds their weights' normalization.
void lay_out(const Grid& grid, const Particles& particles, const Nodes& nodes, std::span<const Vec3> points,
             SurfaceElements& elements) {
    std::vector<std::int16_t> material;
    for (const std::int64_t q : elements.particle)
        material.push_back(particles.material[q]);
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
    std::vector<double> sum;
    interpolate_to_surface(grid, elements, present, sum);
    for (std::size_t s = 0; s < points.size(); ++s)
        elements.normalization[elements.layout.place[s]] = 1.0 / sum[s];
}

} // namespace

FreeSurface find_free_surface(const Grid& grid, const Particles& particles, const Nodes& nodes,
                              const LevelSetOptions& options, bool at_surface) {
    FreeSurface surface;
    surface.phi = signed_distance(grid, particles, options);
    const Field phi_hat = regularized(grid, surface.phi, options);

    const SurfaceGroups near = find_surface_groups(grid, particles, phi_hat);
    Field weight = surface_weights(grid, particles, phi_hat, near);
    Field nodal = sum_at_nodes(grid, particles, near, weight);
    divide_areas_by(grid, surface.phi, nodal);
    share_out_areas(grid, particles, near, nodal, weight);

    SurfaceElements& elements = surface.elements;
    const Field& area = weight;
    Chosen chosen = choose_particles(particles, near, area);
    elements.particle = std::move(chosen.particle);
    for (const std::int64_t entry : chosen.entry)
        elements.area.push_back(area[entry]);
    find_feet(grid, particles, near, surface.phi, phi_hat, chosen.entry, elements);
    std::vector<Vec3> places = elements.point;
    if (!at_surface)
        for (std::size_t s = 0; s < places.size(); ++s)
            places[s] = particles.position[elements.particle[s]];
    lay_out(grid, particles, nodes, places, elements);
    return surface;
}

} // namespace meltscope
