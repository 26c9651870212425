#pragma once

#include "meltscope/run/simulation.hpp"

#include <cstdint>

namespace meltscope {

/// What pictures and files cost a run, measured in turns on one and the same run.
struct InSituCost {
    int steps = 0;                ///< between outputs
    double without_seconds = 0.0; ///< for so many steps, median
    double with_seconds = 0.0;    ///< the same with an output at their start, written whole before the end
    std::int64_t frames = 0, files = 0;
    double snapshot_seconds = 0.0;  ///< of making a snapshot, which the solver waits for, median
    double render_seconds = 0.0;    ///< of one picture beside the solver, on average
    double file_seconds = 0.0;      ///< of one output's data files beside the solver, on average
    double overview_seconds = 0.0;  ///< of one overview picture while the solver rests, median
    double dashboard_seconds = 0.0; ///< of one dashboard, the same

    double ratio() const { return with_seconds / without_seconds; }
};

/// Steps the simulation in turns with and without an overview picture and files of the free surface, the pool
/// and the particles near the surface. They go to a temporary folder that is removed. Throws
/// std::runtime_error if they cannot be made.
InSituCost measure_insitu_cost(Simulation& simulation);

} // namespace meltscope
