#pragma once

#include "meltscope/io/checkpoint.hpp"
#include "meltscope/io/steering.hpp"

#include <string>

namespace meltscope {

/// The ledger's entries by name, J, in the order in which they are shown; `stored` and `stored_at_start`
/// last.
std::vector<std::pair<std::string, double>> ledger_entries(const Ledger& ledger);

/// The reverse of ledger_entries; throws CheckpointError if one is missing.
Ledger ledger_from_entries(const std::vector<std::pair<std::string, double>>& entries);

/// All that a checkpoint holds of a run; `scenario` is the resolved scenario as TOML.
/// /grid/mass_energy holds the nodes with their ghosts, cells + 3 along each axis, without the padding that
/// depends on the SIMD width; /grid/awake says which bricks of bins take part in the step, if not all do.
CheckpointData checkpoint_of(const Run& run, const std::string& scenario);

/// The simulation that a checkpoint holds, under `parameters`. The grid is that of the scenario. Throws
/// CheckpointError if the checkpoint does not fit the grid or the materials.
Simulation simulation_from(const CheckpointData& data, RunParameters parameters, const Grid& grid,
                           int lattice);

/// How many of the scenario's powder layers had been laid.
std::int64_t layers_laid_by(const CheckpointData& data);

/// The solidification data that a checkpoint holds, for the simulation made from it; begun anew if it holds
/// none. Throws CheckpointError if they do not fit.
Solidification solidification_from(const CheckpointData& data, const Simulation& simulation);

} // namespace meltscope
