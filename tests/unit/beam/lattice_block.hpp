#pragma once

#include "meltscope/mpm/free_surface.hpp"
#include "meltscope/mpm/thermal_step.hpp"

#include <cmath>
#include <functional>

namespace meltscope {

/// 316L without the temperature dependence that tests of other things do not need.
inline Material plain_steel() {
    Material material;
    material.name = "steel";
    material.density = 8000.0;
    material.solidus = 1658.0;
    material.liquidus = 1723.0;
    material.latent_heat = 2.7e5;
    material.conductivity.solid = material.conductivity.liquid = {{25.0, 0.0, 0.0}};
    material.heat_capacity.solid = material.heat_capacity.liquid = {{600.0, 0.0, 0.0}};
    material.emissivity = 0.4;
    material.boiling_point = 3068.0;
    material.latent_heat_of_vaporization = 7.45e6;
    material.molar_mass = 0.0558;
    return material;
}

/// A body of lattice particles with all that a step works on.
struct LatticeBody {
    Grid grid;
    std::vector<Material> materials;
    std::vector<EquationOfState> eos;
    Boundary boundary;
    Particles particles;
    Nodes nodes;
    FreeSurface surface;
    StepOptions options;

    /// Ends a step of which the heat has been deposited, and does steps 3 and 4 of the next. Returns the
    /// energy in J that came through faces of fixed temperature.
    double finish_step(double dt) {
        const double in = update_grid_energy(grid, particles, eos, boundary, options, dt, nodes);
        grid_to_particles_to_grid(grid, options, particles, nodes);
        favre_mean(grid, eos, boundary, nodes);
        return in;
    }
};

/// Fills what `inside` says of a box of `cells` cells, its lower corner at the origin, 2 x 2 x 2 particles a
/// cell.
inline LatticeBody make_lattice_body(const Material& material, double dx, const Index3& cells,
                                     double temperature, const std::function<bool(const Vec3&)>& inside,
                                     const Boundary& boundary = {}) {
    LatticeBody body;
    body.grid = make_grid(Vec3::Zero(), dx, cells);
    body.materials = {material};
    body.eos = {make_equation_of_state(material)};
    body.boundary = boundary;
    ParticleList list;
    const double spacing = 0.5 * dx, volume = spacing * spacing * spacing;
    for (std::int64_t k = 0; k < 2 * cells[2]; ++k)
        for (std::int64_t j = 0; j < 2 * cells[1]; ++j)
            for (std::int64_t i = 0; i < 2 * cells[0]; ++i) {
                const Vec3 x = spacing * Vec3(double(i) + 0.5, double(j) + 0.5, double(k) + 0.5);
                if (!inside(x))
                    continue;
                list.id.push_back(list.size());
                list.position.push_back(x);
                list.volume.push_back(volume);
                list.mass.push_back(volume * material.density);
                list.specific_energy.push_back(body.eos[0].energy(temperature));
                list.material.push_back(0);
            }
    body.particles = make_particles(body.grid, std::move(list), 2);
    body.nodes = make_nodes(body.grid, body.particles, 1, boundary);
    body.surface = find_free_surface(body.grid, body.particles, body.nodes, {}, true);
    particles_to_grid(body.grid, body.particles, nullptr, body.nodes);
    favre_mean(body.grid, body.eos, boundary, body.nodes);
    return body;
}

} // namespace meltscope
