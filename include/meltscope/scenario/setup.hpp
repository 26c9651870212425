#pragma once

#include "meltscope/build/shapes.hpp"
#include "meltscope/run/simulation.hpp"
#include "meltscope/scenario/scenario.hpp"

#include <span>
#include <vector>

namespace meltscope {

/// The run's parameters that a scenario asks for.
RunParameters run_parameters(const Scenario& scenario);

/// The grid of a scenario's domain.
Grid scenario_grid(const Scenario& scenario);

/// The bodies' shapes, files read and powder packed onto what the earlier bodies are. Throws GeometryError
/// for bodies that cannot be built.
std::vector<Shape> make_shapes(const Scenario& scenario);

/// Fills the scenario's bodies, that have these shapes, with particles on the lattice.
ParticleList fill_scenario(const Scenario& scenario, std::span<const Shape> shapes);

/// The same, shapes made first.
ParticleList fill_scenario(const Scenario& scenario);

/// Lattice points a cell along an axis: the cube root of particles_per_cell.
int lattice_of(const Scenario& scenario);

/// What a scenario will need, before it is built.
struct Estimate {
    std::int64_t nodes = 0;
    std::int64_t particles_at_most = 0; ///< if the bodies' bounding boxes were full
    double bytes = 0.0;                 ///< of memory, for that many
};
Estimate estimate(const Scenario& scenario);

} // namespace meltscope
