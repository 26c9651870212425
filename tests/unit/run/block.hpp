#pragma once

#include "meltscope/run/simulation.hpp"

#include <cmath>

/// Small blocks of steel that tests of the run room begin with.
namespace meltscope::test {

inline Material steel() {
    Material steel;
    steel.name = "steel";
    steel.density = 8000.0;
    steel.solidus = 1650.0;
    steel.liquidus = 1700.0;
    steel.latent_heat = 2.7e5;
    steel.conductivity.solid.a = {20.0, 0.0, 0.0};
    steel.conductivity.liquid.a = {30.0, 0.0, 0.0};
    steel.conductivity.powder = Polynomial{{0.5, 0.0, 0.0}};
    steel.heat_capacity.solid.a = {500.0, 0.0, 0.0};
    steel.heat_capacity.liquid.a = {700.0, 0.0, 0.0};
    return steel;
}

inline constexpr double block_cell = 10e-6; // m

inline Grid block_grid(const Index3& cells = {12, 8, 8}) {
    return make_grid(Vec3::Zero(), block_cell, cells);
}

/// Eight particles a cell from the floor up to `height` (m), at `temperature` (K); with a packing they are
/// homogenised powder.
inline ParticleList block_particles(const Grid& grid, double height, double temperature,
                                    double packing = 0.0) {
    const Material material = steel();
    const double spacing = 0.5 * grid.dx;
    const double density = material.density * (packing > 0.0 ? packing : 1.0);
    const double energy = make_equation_of_state(material).energy(temperature);
    ParticleList list;
    for (std::int64_t k = 0; k < 2 * grid.cells[2]; ++k)
        for (std::int64_t j = 0; j < 2 * grid.cells[1]; ++j)
            for (std::int64_t i = 0; i < 2 * grid.cells[0]; ++i) {
                const Vec3 x = grid.origin + spacing * Vec3(i + 0.5, j + 0.5, k + 0.5);
                if (x[2] - grid.origin[2] > height)
                    continue;
                list.position.push_back(x);
                list.volume.push_back(std::pow(spacing, 3));
                list.mass.push_back(density * std::pow(spacing, 3));
                list.specific_energy.push_back(energy);
                list.id.push_back(list.size() - 1);
                list.material.push_back(0);
                if (packing > 0.0)
                    list.powder.push_back(1);
            }
    return list;
}

inline RunParameters block_parameters() {
    RunParameters parameters;
    parameters.materials = {steel()};
    parameters.time.end = 1.0;
    parameters.isotherms = {1700.0};
    parameters.physics.quiescent_tolerance = 0.0;
    return parameters;
}

/// A cold block that fills `share` of its domain's height.
inline Simulation steel_block(double share = 1.0, double temperature = 300.0, double packing = 0.0) {
    const Grid grid = block_grid();
    const double height = share * double(grid.cells[2]) * grid.dx;
    return make_simulation(block_parameters(), grid, block_particles(grid, height, temperature, packing), 2);
}

} // namespace meltscope::test
