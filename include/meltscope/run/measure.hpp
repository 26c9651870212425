#pragma once

#include "meltscope/run/simulation.hpp"
#include "meltscope/run/snapshot.hpp"

namespace meltscope {

/// Which particles a snapshot holds.
enum class ParticleSelection { none, surface, melt, all };

/// Takes a snapshot of the run as it stands. Node temperatures are the interpolated field's values at the
/// nodes.
Snapshot take_snapshot(const Simulation& simulation, ParticleSelection particles);

/// What of the material is hotter than one isotherm.
struct IsothermPools {
    std::vector<SeparatePool> pools;   ///< the largest first
    std::vector<PoolFigures> of_beams; ///< each beam's own pool in its own frame
};

/// The pools above `isotherm` (K): regions joined within cells, so that two are told apart if a whole cell
/// between them is colder or empty. Sizes by linear interpolation along the grid's edges. A beam's own is the
/// largest of those that its spot reaches, or else the nearest if no other beam is nearer to it. Without a
/// scan direction a pool is measured along x.
IsothermPools measure_pools(const NodeLattice& nodes, const std::vector<double>& temperature,
                            const std::vector<double>& phi, double isotherm,
                            const std::vector<BeamSnapshot>& beams);

/// Puts the pools of all isotherms (K) into a snapshot that has its node fields and beams.
void measure_pools(const std::vector<double>& isotherms, Snapshot& snapshot);

/// Temperature in K, and phi in m, at any point of the box; NaN where no node has mass. For probes.
struct Probe {
    double temperature, phi;
};
Probe probe(const Simulation& simulation, const Vec3& point);

} // namespace meltscope
