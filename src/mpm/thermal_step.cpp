#include "meltscope/mpm/thermal_step.hpp"

#include "meltscope/mpm/group_stencils.hpp"

#include "slope_limit.hpp"

namespace meltscope {
namespace {

/// e(T_i) of the one material, into the storage of e*, which step 6 fills later.
const Field& energy_of_temperature(const EquationOfState& eos, Nodes& nodes) {
    Field& energy = nodes.new_energy[0];
    for_each_node_lanes(nodes.spans,
                        [&](std::int64_t i) { store(eos.energy(load(&nodes.temperature[i])), &energy[i]); });
    return energy;
}

/// e* on and beyond faces of fixed temperature, for one material.
void fix_face_energies(const Grid& grid, const Boundary& boundary, const EquationOfState& eos,
                       const Field& inertia, Field& new_energy) {
    for (int f = 0; f < 6; ++f)
        if (boundary[f].fixes_temperature()) {
            const double wall = boundary[f].temperature;
            const double wall_energy = eos.energy(wall);
            for_each_face_node(grid, f, [&](std::int64_t ghost, std::int64_t face, std::int64_t mirror) {
                if (inertia[mirror] > 0.0) {
                    new_energy[face] = wall_energy;
                    new_energy[ghost] = eos.energy(2.0 * wall - eos.temperature(new_energy[mirror]));
                }
            });
        }
}

double sum_near_fixed_faces(const Nodes& nodes, const Field& field) {
    double sum = 0.0;
    for (const std::int64_t i : nodes.near_fixed_faces)
        sum += field[i];
    return sum;
}

/// q_i = (1 - 2 alpha_i dt / dx^2) D_i / m_i of nodes with one material outside its mushy range; zero
/// elsewhere, where the energy may jump and a sharper increment would overshoot. Nor is it larger than what
/// the node has above the least energy: what a node gains by a sharper increment its neighbours lose, and
/// where a laser has only begun to heat they have nothing to give yet.
void lumping_error(const Grid& grid, const std::vector<EquationOfState>& materials, const Boundary& boundary,
                   const StepOptions& options, const Field& inertia, double dt, const Nodes& nodes,
                   Field& q) {
    const double scale = 2.0 * dt / (grid.dx * grid.dx);
    for_each_node_lanes(nodes.spans, [&](std::int64_t i) {
        const Lanes mass = load(&inertia[i]);
        Lanes result(0.0);
        if (any_of(mass > 0.0)) {
            const Lanes t = load(&nodes.temperature[i]);
            const Lanes rise = load(&nodes.increment[i]) / select(mass > 0.0, mass, Lanes(1.0));
            for (std::size_t a = 0; a < materials.size(); ++a) {
                const EquationOfState& eos = materials[a];
                const Lanes alpha = eos.conductivity(t) / (eos.density * eos.heat_capacity(t));
                const auto solid_or_liquid = (t < eos.solidus) || (t >= eos.liquidus);
                const auto present =
                    nodes.several_materials() ? load(&nodes.material_mass[a][i]) > 0.0 : mass > 0.0;
                Lanes sharper = (1.0 - scale * alpha) * rise;
                if (!options.least_energy.empty()) {
                    const Lanes room = max(load(&nodes.energy[a][i]) - options.least_energy[a], Lanes(0.0));
                    sharper = min(max(sharper, -room), room);
                }
                // A sum of one: nodes of several materials follow below.
                result += select(present && solid_or_liquid, sharper, Lanes(0.0));
            }
        }
        store(result, &q[i]);
    });
    for (const std::int64_t i : nodes.mixed)
        q[i] = 0.0;
    mirror_ghosts(grid, boundary, q);
    for (int f = 0; f < 6; ++f)
        if (boundary[f].fixes_temperature())
            for_each_face_node(grid, f, [&](std::int64_t ghost, std::int64_t face, std::int64_t mirror) {
                q[face] = 0.0;
                q[ghost] = -q[mirror];
            });
}

/// Makes up for the lumped mass: D_i += m_i q_i - sum_p m_p N_ip sum_j N_jp q_j. With q = D/m this is one
/// Jacobi sweep towards the consistent mass, which removes the scheme's error of order dx^2 (lumping smooths
/// heat sources and slows short waves by k^2 dx^2 / 4); the part of q that grows with dt removes Euler's
/// error of order dt, half (alpha k^2)^2 dt, in the same breath. Takes the sum off D_i and leaves q in the
/// storage of e*, for step 6 to add; returns the change of D in J near faces of fixed temperature.
double undo_lumping(const Grid& grid, const Particles& particles,
                    const std::vector<EquationOfState>& materials, const Boundary& boundary,
                    const StepOptions& options, const Field& inertia, double dt, Nodes& nodes) {
    Field& q = nodes.new_energy[0]; // free until e* is known
    lumping_error(grid, materials, boundary, options, inertia, dt, nodes, q);
    double change = -sum_near_fixed_faces(nodes, nodes.increment);

    const LatticeStencils lattices;
    for_each_block(particles.awake, [&](const LaneBlock& block) {
        for (std::int64_t g = block.first_group; g < block.last_group; ++g) {
            const LaneGroup& group = particles.layout.groups[g];
            NodeSums sums;
            for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
                std::array<Lanes, std::decay_t<decltype(stencil)>::points> value;
                stencil.gather(q.data() + group.corner, grid.stride_y, grid.stride_z, value);
                for (std::size_t p = 0; p < value.size(); ++p)
                    value[p] *= -load(&particles.mass[first + p * lane_count]);
                stencil.scatter_value(value, sums);
            });
            sums.add_to(nodes.increment.data(), group.corner, grid.stride_y, grid.stride_z);
        }
    });
    change += sum_near_fixed_faces(nodes, nodes.increment);
    for (const std::int64_t i : nodes.near_fixed_faces)
        change += nodes.mass[i] * q[i];

    fold_ghosts(grid, boundary, AtFixedFaces::odd, nodes.increment);
    return change;
}

/// Homogenised powder conducts as powder until it has melted once: marks what reaches the liquidus as bulk
/// and puts the powder's conductivity into `factor` = scale v_p kappa_p of the rest.
template <std::size_t n>
void conduct_as_powder(const EquationOfState& eos, const std::array<Lanes, n>& temperature,
                       const double* volume, double scale, double* powder, std::array<Lanes, n>& factor) {
    const Polynomial kappa = eos.powder_conductivity.value_or(Polynomial{});
    for (std::size_t p = 0; p < n; ++p) {
        const Lanes& t = temperature[p];
        const Lanes left = select(t < eos.liquidus, load(powder + p * lane_count), Lanes(0.0));
        store(left, powder + p * lane_count);
        const Lanes of_powder = kappa.a[0] + t * (kappa.a[1] + t * kappa.a[2]);
        factor[p] += scale * load(volume + p * lane_count) * left * (of_powder - eos.conductivity(t));
    }
}

} // namespace

void diffuse(const Grid& grid, Particles& particles, const std::vector<EquationOfState>& materials,
             const StepOptions& options, double dt, Nodes& nodes) {
    const LatticeStencils lattices;
    const double* temperature = nodes.temperature.data();
    const double* energy =
        options.energy_gradient ? energy_of_temperature(materials[0], nodes).data() : nullptr;
    const bool has_powder = !particles.powder.empty();
    const double scale = -dt / (grid.dx * grid.dx); // gradients come per cell, one of T and one of N
    for_each_block(particles.awake, [&](const LaneBlock& block) {
        for (std::int64_t g = block.first_group; g < block.last_group; ++g) {
            const LaneGroup& group = particles.layout.groups[g];
            const EquationOfState& eos = materials[group.kind];
            NodeSums sums;
            for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
                using Stencil = std::decay_t<decltype(stencil)>;
                typename Stencil::Points flux; // first grad T, then F
                stencil.gather(temperature + group.corner, grid.stride_y, grid.stride_z, flux);
                std::array<Lanes, Stencil::points> factor;
                for (int p = 0; p < Stencil::points; ++p)
                    factor[p] = scale * load(&particles.volume[first + p * lane_count]) *
                                eos.conductivity(flux.value[p]);
                if (has_powder)
                    conduct_as_powder(eos, flux.value, &particles.volume[first], scale,
                                      &particles.powder[first], factor);
                if (energy) {
                    for (int p = 0; p < Stencil::points; ++p)
                        factor[p] /= eos.heat_capacity(flux.value[p]);
                    stencil.gather(energy + group.corner, grid.stride_y, grid.stride_z, flux);
                }
                for (int p = 0; p < Stencil::points; ++p) {
                    flux.x[p] *= factor[p];
                    flux.y[p] *= factor[p];
                    flux.z[p] *= factor[p];
                }
                stencil.scatter_gradient(flux, sums);
            });
            sums.add_to(nodes.increment.data(), group.corner, grid.stride_y, grid.stride_z);
        }
    });
}

double update_grid_energy(const Grid& grid, const Particles& particles,
                          const std::vector<EquationOfState>& materials, const Boundary& boundary,
                          const StepOptions& options, double dt, Nodes& nodes) {
    const int count = int(materials.size());
    // What deposit() left on nodes without mass never comes in, here or elsewhere; on ghosts it must not be
    // folded either.
    fold_ghosts(grid, boundary, AtFixedFaces::leave, nodes.increment);
    double conducted = 0.0; // J
    for (const std::int64_t i : nodes.near_fixed_faces) {
        if (nodes.mass[i] > 0.0)
            conducted -= nodes.increment[i];
        else
            nodes.increment[i] = 0.0;
    }
    fold_ghosts(grid, boundary, AtFixedFaces::odd, nodes.increment);
    const Field& inertia = nodes.inertia.empty() ? nodes.mass : nodes.inertia;
    if (options.affine)
        conducted -= undo_lumping(grid, particles, materials, boundary, options, inertia, dt, nodes);

    // e_i* = e_i + D_i / m_i, and q_i is D_i / m_i that undo_lumping has not added yet
    for_each_node_lanes(nodes.spans, [&](std::int64_t i) {
        const Lanes mass = load(&inertia[i]);
        const auto filled = mass > 0.0;
        Lanes rise = select(filled, load(&nodes.increment[i]) / select(filled, mass, Lanes(1.0)), Lanes(0.0));
        if (options.affine)
            rise += select(filled, load(&nodes.new_energy[0][i]), Lanes(0.0));
        for (int a = 0; a < count; ++a)
            store(load(&nodes.energy[a][i]) + rise, &nodes.new_energy[a][i]);
    });
#pragma omp parallel for schedule(static)
    for (const std::int64_t i : nodes.mixed) {
        if (!(nodes.mass[i] > 0.0))
            continue;
        const double total = nodes.mass_energy[i] + nodes.increment[i] * nodes.mass[i] / inertia[i];
        const double t = mixture_temperature(materials, nodes.material_mass, i, total);
        for (int a = 0; a < count; ++a)
            nodes.new_energy[a][i] = materials[a].energy(t);
    }
    for (int a = 0; a < count; ++a) {
        if (!nodes.near_fixed_faces.empty())
            fix_face_energies(grid, boundary, materials[a], inertia, nodes.new_energy[a]);
        // Last: where two faces meet it copies what was set.
        mirror_ghosts(grid, boundary, nodes.new_energy[a]);
    }

    // What the particles will gain beyond D_i near these faces came through them.
    for (const std::int64_t i : nodes.near_fixed_faces)
        for (int a = 0; a < count; ++a) {
            const double mass = nodes.several_materials() ? nodes.material_mass[a][i] : nodes.mass[i];
            if (mass > 0.0)
                conducted += mass * (nodes.new_energy[a][i] - nodes.energy[a][i]);
        }

    // The blend of step 7 needs sum_i N_ip (e_i* - (1 - b) e_i) only.
    const double keep = 1.0 - options.blend;
    for_each_node_lanes(nodes.spans, [&](std::int64_t i) {
        for (int a = 0; a < count; ++a)
            store(load(&nodes.new_energy[a][i]) - keep * load(&nodes.energy[a][i]), &nodes.energy[a][i]);
        store(Lanes(0.0), &nodes.increment[i]);
        const auto filled = load(&nodes.mass[i]) > 0.0; // elsewhere sleeping particles' energy stays
        store(select(filled, Lanes(0.0), load(&nodes.mass_energy[i])), &nodes.mass_energy[i]);
    });
    return conducted;
}

void grid_to_particles_to_grid(const Grid& grid, const StepOptions& options, Particles& particles,
                               Nodes& nodes) {
    const LatticeStencils lattices;
    const double keep = 1.0 - options.blend;
    const bool limited = options.affine && !options.least_energy.empty();
    for_each_block(particles.awake, [&](const LaneBlock& block) {
        for (std::int64_t g = block.first_group; g < block.last_group; ++g) {
            const LaneGroup& group = particles.layout.groups[g];
            const double* change = nodes.energy[group.kind].data() + group.corner;
            const double* new_energy = nodes.new_energy[group.kind].data() + group.corner;
            const Lanes least =
                limited ? least_energy_of_group(grid, nodes.boundary, group, options.least_energy[group.kind])
                        : Lanes(0.0);
            NodeSums sums;
            for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
                using Stencil = std::decay_t<decltype(stencil)>;
                std::array<Lanes, Stencil::points> energy;
                stencil.gather(change, grid.stride_y, grid.stride_z, energy);
                for (int p = 0; p < Stencil::points; ++p) {
                    double* e = &particles.specific_energy[first + p * lane_count];
                    energy[p] += keep * load(e);
                    store(energy[p], e);
                    energy[p] *= load(&particles.mass[first + p * lane_count]);
                }
                if (!options.affine)
                    return stencil.scatter_value(energy, sums);
                typename Stencil::Points gradient;
                stencil.gather(new_energy, grid.stride_y, grid.stride_z, gradient);
                if (limited)
                    shorten_slopes(least, &particles.specific_energy[first], gradient);
                for (int p = 0; p < Stencil::points; ++p) {
                    const Lanes mass = load(&particles.mass[first + p * lane_count]);
                    gradient.value[p] = energy[p];
                    gradient.x[p] *= mass;
                    gradient.y[p] *= mass;
                    gradient.z[p] *= mass;
                }
                stencil.scatter_affine(gradient, sums);
            });
            sums.add_to(nodes.mass_energy.data(), group.corner, grid.stride_y, grid.stride_z);
        }
    });
}

Field interpolate_to_particles(const Grid& grid, const Particles& particles, const Field& nodal) {
    const LatticeStencils lattices;
    Field result(particles.layout.size(), 0.0);
#pragma omp parallel for schedule(static)
    for (std::size_t g = 0; g < particles.layout.groups.size(); ++g) {
        const LaneGroup& group = particles.layout.groups[g];
        for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
            std::array<Lanes, std::decay_t<decltype(stencil)>::points> value;
            stencil.gather(nodal.data() + group.corner, grid.stride_y, grid.stride_z, value);
            for (std::size_t p = 0; p < value.size(); ++p)
                store(value[p], &result[first + p * lane_count]);
        });
    }
    return result;
}

} // namespace meltscope
