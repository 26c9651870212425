#pragma once

#include "meltscope/run/simulation.hpp"
#include "meltscope/run/snapshot.hpp"

namespace meltscope {

/// Which particles a snapshot holds.
enum class ParticleSelection { none, surface, melt, all };

/// Takes a snapshot of the run as it stands. Node temperatures are the interpolated field's values at the
/// nodes.
Snapshot take_snapshot(const Simulation& simulation, ParticleSelection particles);

/// Length, width, depth and volume of the region hotter than `isotherm` (K) in the material, with linear
/// interpolation along the grid's edges. `along` is the horizontal scan direction (zero: x). All zero if
/// nothing is that hot.
PoolFigures measure_pool(const NodeLattice& nodes, const std::vector<double>& temperature,
                         const std::vector<double>& phi, double isotherm, const Vec3& along);

/// Temperature in K, and phi in m, at any point of the box; NaN where no node has mass. For probes.
struct Probe {
    double temperature, phi;
};
Probe probe(const Simulation& simulation, const Vec3& point);

} // namespace meltscope
