#include "meltscope/mpm/free_surface.hpp"

#include "meltscope/mpm/group_stencils.hpp"

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

/// Interpolates `field` to the particles, layout order; with `gradient`, |sum_i f_i grad N_ip| in 1/m
/// instead.
Field gather_to_particles(const Grid& grid, const Particles& particles, const Field& field, bool gradient) {
    const LatticeStencils lattices;
    Field result(particles.layout.size(), 0.0);
#pragma omp parallel for schedule(static)
    for (std::size_t g = 0; g < particles.layout.groups.size(); ++g) {
        const LaneGroup& group = particles.layout.groups[g];
        for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
            using Stencil = std::decay_t<decltype(stencil)>;
            typename Stencil::Points f;
            stencil.gather(field.data() + group.corner, grid.stride_y, grid.stride_z, f);
            for (int p = 0; p < Stencil::points; ++p) {
                const Lanes value = gradient
                                        ? sqrt(f.x[p] * f.x[p] + f.y[p] * f.y[p] + f.z[p] * f.z[p]) / grid.dx
                                        : f.value[p];
                store(value, &result[first + p * lane_count]);
            }
        });
    }
    return result;
}

/// A_i = dx^3 |grad phi_i| hat(phi_i), the box's share of the node's cell. The hat is (|n_x| + |n_y| + |n_z|)
/// dx wide to either side, so that its sum over the nodes is that of a plane of any tilt: B. Engquist, A.-K.
/// Tornberg, R. Tsai, J. Comput. Phys. 207 (2005) 28.
Field node_areas(const Grid& grid, const Field& phi) {
    Field area(grid.size, 0.0);
    const double dx = grid.dx;
#pragma omp parallel for schedule(static)
    for (std::int64_t k = 0; k <= grid.cells[2]; ++k)
        for (std::int64_t j = 0; j <= grid.cells[1]; ++j)
            for (std::int64_t i = 0; i <= grid.cells[0]; ++i) {
                const std::int64_t at = grid.index(i, j, k);
                if (std::abs(phi[at]) >= std::sqrt(3.0) * dx)
                    continue;
                const Vec3 gradient =
                    Vec3(phi[at + 1] - phi[at - 1], phi[at + grid.stride_y] - phi[at - grid.stride_y],
                         phi[at + grid.stride_z] - phi[at - grid.stride_z]) /
                    (2.0 * dx);
                const double slope = gradient.norm();
                if (slope == 0.0)
                    continue;
                const double width = dx * gradient.lpNorm<1>() / slope;
                const double hat = std::max(0.0, 1.0 - std::abs(phi[at]) / width) / width;
                area[at] = dx * dx * dx * grid.share_in_box(i, j, k) * slope * hat;
            }
    return area;
}

/// The value and the gradient (per m) of a nodal field at one point, by the B-spline.
struct Sample {
    double value;
    Vec3 gradient;
};

Sample sample(const Grid& grid, const Field& f, const Vec3& point) {
    const BinPlace bin = bin_place(grid, point);
    const std::array<BSpline<double>, 3> n{BSpline<double>(bin.offset[0]), BSpline<double>(bin.offset[1]),
                                           BSpline<double>(bin.offset[2])};
    Sample result{0.0, Vec3::Zero()};
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) {
                const double value =
                    f[grid.index(bin.node[0] + i - 1, bin.node[1] + j - 1, bin.node[2] + k - 1)];
                result.value += value * n[0].value[i] * n[1].value[j] * n[2].value[k];
                result.gradient += value * Vec3(n[0].derivative[i] * n[1].value[j] * n[2].value[k],
                                                n[0].value[i] * n[1].derivative[j] * n[2].value[k],
                                                n[0].value[i] * n[1].value[j] * n[2].derivative[k]);
            }
    result.gradient /= grid.dx;
    return result;
}

/// Lays out the points where the heat goes in and finds their weights' normalization.
void lay_out(const Grid& grid, const Nodes& nodes, std::span<const Vec3> points, SurfaceElements& elements) {
    elements.layout = make_lane_layout(grid, points, {}, 0);
    for (Field* field : {&elements.offset_x, &elements.offset_y, &elements.offset_z, &elements.normalization})
        field->assign(elements.layout.size(), 0.0);
    Field present(grid.size, 0.0);
    for (std::int64_t i = 0; i < grid.size; ++i)
        present[i] = nodes.mass[i] > 0.0 ? 1.0 : 0.0;
    // Beyond faces of fixed temperature ghosts have a mass of their own.
    mirror_ghosts(grid, nodes.boundary, present);
#pragma omp parallel for schedule(static)
    for (std::size_t s = 0; s < points.size(); ++s) {
        const BinPlace bin = bin_place(grid, points[s]);
        const std::int64_t at = elements.layout.place[s];
        elements.offset_x[at] = bin.offset[0];
        elements.offset_y[at] = bin.offset[1];
        elements.offset_z[at] = bin.offset[2];
        elements.normalization[at] = 1.0 / sample(grid, present, points[s]).value;
    }
}

} // namespace

FreeSurface find_free_surface(const Grid& grid, const Particles& particles, const Nodes& nodes,
                              const LevelSetOptions& options, bool at_surface) {
    FreeSurface surface;
    surface.phi = signed_distance(grid, particles, options);
    surface.phi_hat = regularized(grid, surface.phi, options);

    // s_p, and sum_q N_iq s_q
    const Field phi_hat = gather_to_particles(grid, particles, surface.phi_hat, false);
    Field weight = gather_to_particles(grid, particles, surface.phi_hat, true);
#pragma omp parallel for schedule(static)
    for (std::size_t at = 0; at < weight.size(); ++at)
        weight[at] = std::abs(phi_hat[at]) <= surface_gate ? weight[at] * particles.volume[at] : 0.0;
    Field total(grid.size, 0.0);
    scatter_to_nodes(grid, particles, weight, total);
    fold_ghosts(grid, Boundary{}, AtFixedFaces::leave, total);

    // a_p = s_p sum_i N_ip A_i / sum_q N_iq s_q
    Field ratio = node_areas(grid, surface.phi);
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < grid.size; ++i)
        ratio[i] = total[i] > 0.0 ? ratio[i] / total[i] : 0.0;
    mirror_ghosts(grid, Boundary{}, ratio);
    const Field area_share = gather_to_particles(grid, particles, ratio, false);

    SurfaceElements& elements = surface.elements;
    for (std::int64_t q = 0; q < particles.count(); ++q) {
        const std::int64_t at = particles.layout.place[q];
        if (weight[at] * area_share[at] > 0.0) {
            elements.particle.push_back(q);
            elements.area.push_back(weight[at] * area_share[at]);
        }
    }
    elements.point.resize(elements.particle.size());
    elements.normal.resize(elements.particle.size());
#pragma omp parallel for schedule(static)
    for (std::size_t s = 0; s < elements.particle.size(); ++s) {
        const Vec3& x = particles.position[elements.particle[s]];
        const Vec3 normal = sample(grid, surface.phi_hat, x).gradient.normalized();
        elements.normal[s] = normal;
        elements.point[s] = (x - sample(grid, surface.phi, x).value * normal)
                                .cwiseMax(grid.origin)
                                .cwiseMin(grid.upper_corner());
    }
    std::vector<Vec3> places = elements.point;
    if (!at_surface)
        for (std::size_t s = 0; s < places.size(); ++s)
            places[s] = particles.position[elements.particle[s]];
    lay_out(grid, nodes, places, elements);
    return surface;
}

void deposit(const Grid& grid, const SurfaceElements& elements, std::span<const double> energy,
             Nodes& nodes) {
    Field in_layout(elements.layout.size(), 0.0);
    for (std::size_t s = 0; s < energy.size(); ++s) {
        const std::int64_t at = elements.layout.place[s];
        in_layout[at] = energy[s] * elements.normalization[at];
    }
    // A node without mass takes its share too, which the normalization has given to the others; step 6
    // ignores it.
    for_each_block(elements.layout, [&](const LaneBlock& block) {
        for (std::int64_t g = block.first_group; g < block.last_group; ++g) {
            const LaneGroup& group = elements.layout.groups[g];
            NodeSums sums;
            bool any = false;
            for (std::int64_t slot = group.first_slot; slot < group.first_slot + group.slots; ++slot) {
                const Lanes joule = load(&in_layout[slot * lane_count]);
                if (all_of(joule == 0.0))
                    continue;
                any = true;
                point_stencil(elements.offset_x.data(), elements.offset_y.data(), elements.offset_z.data(),
                              slot)
                    .scatter_value({joule}, sums);
            }
            if (any)
                sums.add_to(nodes.increment.data(), group.corner, grid.stride_y, grid.stride_z);
        }
    });
}

void interpolate_to_surface(const Grid& grid, const SurfaceElements& elements, const Field& field,
                            std::vector<double>& interpolated) {
    Field in_layout(elements.layout.size(), 0.0);
#pragma omp parallel for schedule(static)
    for (std::size_t g = 0; g < elements.layout.groups.size(); ++g) {
        const LaneGroup& group = elements.layout.groups[g];
        for (std::int64_t slot = group.first_slot; slot < group.first_slot + group.slots; ++slot) {
            std::array<Lanes, 1> value;
            point_stencil(elements.offset_x.data(), elements.offset_y.data(), elements.offset_z.data(), slot)
                .gather(field.data() + group.corner, grid.stride_y, grid.stride_z, value);
            store(value[0] * load(&elements.normalization[slot * lane_count]), &in_layout[slot * lane_count]);
        }
    }
    interpolated.resize(elements.particle.size());
#pragma omp parallel for schedule(static)
    for (std::size_t s = 0; s < interpolated.size(); ++s)
        interpolated[s] = in_layout[elements.layout.place[s]];
}

void surface_temperatures(const Grid& grid, const SurfaceElements& elements, const Nodes& nodes,
                          std::vector<double>& temperature) {
    interpolate_to_surface(grid, elements, nodes.temperature, temperature);
}

} // namespace meltscope
