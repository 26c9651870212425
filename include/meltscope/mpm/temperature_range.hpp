#pragma once

#include "meltscope/mpm/nodes.hpp"

namespace meltscope {

/// What the particles see of the nodes' temperatures.
struct TemperatureRange {
    double coldest = 0.0, hottest = 0.0; ///< K, over the particles, rounded outwards to whole kelvins
    bool finite = true;                  ///< no node that they see holds what is not a number
};

/// Rounds a temperature in K outwards.
double down_to_whole_kelvin(double t);
double up_to_whole_kelvin(double t);

/// The range of sum_i T_i N_ip over the particles that are awake.
///
/// A node that hangs on the edge of a few particles extrapolates and may be far hotter or colder than they
/// are. A particle's temperature is a weighted mean of those of its 27 nodes, so these bound it: only the few
/// groups of particles whose bounds lie beyond what others have are interpolated to.
TemperatureRange particle_temperature_range(const Grid& grid, const Particles& particles, const Nodes& nodes);

} // namespace meltscope
