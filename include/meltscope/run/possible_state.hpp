#pragma once

#include "meltscope/run/simulation.hpp"

#include <stdexcept>

namespace meltscope {

/// The solution has left what is possible; what() names particle, place, step and the likely cause.
struct SolutionError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// No run of this program is about matter hotter than this, K.
inline constexpr double highest_possible_temperature = 1e6;

/// What the particles' temperatures were after the last step.
struct ReachedTemperatures {
    bool finite = true;
    double coldest = 0.0, hottest = 0.0; ///< K
};

/// Throws SolutionError if they hold what is not a number, below absolute zero or above the highest possible
/// temperature. Which particle it is is looked for only then: while all is well this compares three values.
void require_possible(const Simulation& simulation, const ReachedTemperatures& reached);

} // namespace meltscope
