#pragma once

#include "meltscope/aligned.hpp"
#include "meltscope/run/solidified_point.hpp"

#include <cstdint>
#include <vector>

namespace meltscope {

struct Simulation;

/// Solidification data of a run, node by node of the regular grid: a row for every time a node in the
/// material freezes. Between steps temperature and its gradient are linear in time. A plain value; what a
/// checkpoint must hold of it are `melted_at` and `points`.
struct Solidification {
    std::vector<SolidifiedPoint> points; ///< step by step, within a step in the order of the nodes
    Field melted_at;                     ///< s, nodal: since when the node is molten; negative: it is not
    std::int64_t molten = 0;             ///< nodes that are molten
    Field previous;                      ///< K, nodal temperatures when last looked at
    double previous_time = 0.0;          ///< s
};

/// Starts with what is molten now.
Solidification begin_solidification(const Simulation& simulation);

/// Goes on with what a checkpoint holds. Throws std::invalid_argument if `melted_at` does not fit the grid.
Solidification resume_solidification(const Simulation& simulation, Field melted_at,
                                     std::vector<SolidifiedPoint> points);

/// Looks at the temperatures after a step. A node's liquidus is that of the material of which it has most.
void record_solidification(const Simulation& simulation, Solidification& record);

} // namespace meltscope
