#include "meltscope/mpm/nodes.hpp"

#include "meltscope/mpm/group_stencils.hpp"

#include <cmath>

namespace meltscope {
namespace {

/// Nodes that hold more than one material.
std::vector<std::int64_t> mixed_nodes(const Grid& grid, const std::vector<Field>& material_mass) {
    std::vector<std::int64_t> mixed;
    for (std::int64_t i = 0; i < grid.size; ++i) {
        int present = 0;
        for (const Field& mass : material_mass)
            present += mass[i] > 0.0;
        if (present > 1)
            mixed.push_back(i);
    }
    return mixed;
}

} // namespace

double mixture_temperature(const std::vector<EquationOfState>& materials,
                           const std::vector<Field>& material_mass, std::int64_t node, double total) {
    double low = 1e300, high = -1e300;
    double mass = 0.0;
    for (std::size_t a = 0; a < materials.size(); ++a)
        mass += material_mass[a][node];
    for (std::size_t a = 0; a < materials.size(); ++a)
        if (material_mass[a][node] > 0.0) {
            const double alone = materials[a].temperature(total / mass);
            low = std::min(low, alone);
            high = std::max(high, alone);
        }
    // Newton on a monotone function, bracketed so that latent heat cannot throw it off.
    double t = 0.5 * (low + high);
    for (int iteration = 0; iteration < 100; ++iteration) {
        double energy = -total, capacity = 0.0;
        for (std::size_t a = 0; a < materials.size(); ++a) {
            energy += material_mass[a][node] * materials[a].energy(t);
            capacity += material_mass[a][node] * materials[a].heat_capacity(t);
        }
        (energy > 0.0 ? high : low) = t;
        double next = t - energy / capacity;
        if (std::abs(next - t) <= 1e-13 * std::abs(t))
            return next;
        if (!(next > low && next < high)) // at an end it would go to and fro for ever
            next = 0.5 * (low + high);
        t = next;
    }
    return t;
}

void add_node_mass(const Grid& grid, const Particles& particles, const GroupRuns& groups, int material,
                   Field& mass) {
    const LatticeStencils lattices;
    for_each_block(groups, [&](const LaneBlock& run) {
        for (std::int64_t g = run.first_group; g < run.last_group; ++g) {
            const LaneGroup& group = particles.layout.groups[g];
            if (material < 0 || group.kind == material)
                scatter_group(grid, particles, lattices, group, particles.mass, mass);
        }
    });
}

void find_node_masses(const Grid& grid, const Particles& particles, const Boundary& boundary, Nodes& nodes) {
    const auto sum_up = [&](int material, Field& mass) {
        mass.assign(grid.size, 0.0);
        add_node_mass(grid, particles, particles.awake, material, mass);
    };
    sum_up(-1, nodes.mass);
    if (!nodes.near_fixed_faces.empty()) {
        nodes.inertia = nodes.mass;
        fold_ghosts(grid, boundary, AtFixedFaces::even, nodes.inertia);
    }
    fold_ghosts(grid, boundary, AtFixedFaces::leave, nodes.mass);
    for (std::size_t a = 0; a < nodes.material_mass.size(); ++a) {
        sum_up(int(a), nodes.material_mass[a]);
        fold_ghosts(grid, boundary, AtFixedFaces::leave, nodes.material_mass[a]);
    }
}

std::vector<NodeSpan> all_nodes(const Grid& grid) {
    std::vector<NodeSpan> spans;
    for (std::int64_t row = 0; row < grid.size; row += grid.stride_y)
        spans.push_back({row, row + grid.stride_y});
    return spans;
}

Nodes make_nodes(const Grid& grid, const Particles& particles, int materials, const Boundary& boundary) {
    Nodes nodes;
    nodes.spans = all_nodes(grid);
    for (Field* field : {&nodes.mass_energy, &nodes.temperature, &nodes.increment})
        field->assign(grid.size, 0.0);
    nodes.energy.assign(materials, Field(grid.size, 0.0));
    nodes.new_energy.assign(materials, Field(grid.size, 0.0));
    nodes.boundary = boundary;
    nodes.near_fixed_faces = nodes_near_fixed_faces(grid, boundary);
    if (materials > 1)
        nodes.material_mass.resize(materials);
    find_node_masses(grid, particles, boundary, nodes);
    if (materials > 1)
        nodes.mixed = mixed_nodes(grid, nodes.material_mass);
    return nodes;
}

void add_node_energy(const Grid& grid, const Particles& particles, const GroupRuns& groups,
                     const std::vector<Field>* gradient_of, Field& mass_energy) {
    const LatticeStencils lattices;
    for_each_block(groups, [&](const LaneBlock& run) {
        for (std::int64_t g = run.first_group; g < run.last_group; ++g) {
            const LaneGroup& group = particles.layout.groups[g];
            NodeSums sums;
            for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
                using Stencil = std::decay_t<decltype(stencil)>;
                std::array<Lanes, Stencil::points> energy;
                for (int p = 0; p < Stencil::points; ++p)
                    energy[p] = load(&particles.mass[first + p * lane_count]) *
                                load(&particles.specific_energy[first + p * lane_count]);
                if (!gradient_of)
                    return stencil.scatter_value(energy, sums);
                typename Stencil::Points gradient;
                stencil.gather((*gradient_of)[group.kind].data() + group.corner, grid.stride_y, grid.stride_z,
                               gradient);
                for (int p = 0; p < Stencil::points; ++p) {
                    const Lanes mass = load(&particles.mass[first + p * lane_count]);
                    gradient.value[p] = energy[p];
                    gradient.x[p] *= mass;
                    gradient.y[p] *= mass;
                    gradient.z[p] *= mass;
                }
                stencil.scatter_affine(gradient, sums);
            });
            sums.add_to(mass_energy.data(), group.corner, grid.stride_y, grid.stride_z);
        }
    });
}

void particles_to_grid(const Grid& grid, const Particles& particles, const std::vector<Field>* gradient_of,
                       Nodes& nodes) {
    std::fill(nodes.mass_energy.begin(), nodes.mass_energy.end(), 0.0);
    add_node_energy(grid, particles, particles.awake, gradient_of, nodes.mass_energy);
}

void favre_mean(const Grid& grid, const std::vector<EquationOfState>& materials, const Boundary& boundary,
                const std::vector<NodeSpan>& spans, Nodes& nodes) {
    fold_ghosts(grid, boundary, AtFixedFaces::leave, nodes.mass_energy);
    const int count = int(materials.size());
    for_each_node_lanes(spans, [&](std::int64_t i) {
        const Lanes mass = load(&nodes.mass[i]);
        const auto filled = mass > 0.0;
        if (none_of(filled))
            return;
        const Lanes energy =
            select(filled, load(&nodes.mass_energy[i]) / select(filled, mass, Lanes(1.0)), Lanes(0.0));
        Lanes temperature = load(&nodes.temperature[i]);
        if (count == 1) {
            store(energy, &nodes.energy[0][i]);
            store(select(filled, materials[0].temperature(energy), temperature), &nodes.temperature[i]);
            return;
        }
        for (int a = 0; a < count; ++a) {
            const auto present = load(&nodes.material_mass[a][i]) > 0.0;
            store(select(present, energy, Lanes(0.0)), &nodes.energy[a][i]);
            temperature = select(present, materials[a].temperature(energy), temperature);
        }
        store(temperature, &nodes.temperature[i]);
    });
#pragma omp parallel for schedule(static)
    for (std::int64_t i : nodes.mixed) {
        if (!(nodes.mass[i] > 0.0))
            continue;
        const double t = mixture_temperature(materials, nodes.material_mass, i, nodes.mass_energy[i]);
        nodes.temperature[i] = t;
        for (int a = 0; a < count; ++a)
            nodes.energy[a][i] = materials[a].energy(t);
    }

    for (int a = 0; a < count; ++a)
        mirror_ghosts(grid, boundary, nodes.energy[a]);
    // An odd continuation about the face's temperature: what is linear through the face stays linear.
    for (int f = 0; f < 6; ++f)
        if (boundary[f].fixes_temperature())
            for_each_face_node(grid, f, [&](std::int64_t ghost, std::int64_t face, std::int64_t mirror) {
                // What has no temperature no particle reaches, be it awake or asleep.
                if (nodes.temperature[face] != 0.0)
                    nodes.temperature[face] = boundary[f].temperature;
                if (nodes.temperature[ghost] != 0.0)
                    nodes.temperature[ghost] = 2.0 * boundary[f].temperature - nodes.temperature[mirror];
            });
    mirror_ghosts(grid, boundary, nodes.temperature); // last: where two faces meet it copies what was set
}

void favre_mean(const Grid& grid, const std::vector<EquationOfState>& materials, const Boundary& boundary,
                Nodes& nodes) {
    favre_mean(grid, materials, boundary, nodes.spans, nodes);
}

} // namespace meltscope
