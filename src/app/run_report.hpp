#pragma once

#include "meltscope/io/run_folder.hpp"

#include <functional>
#include <string>

namespace meltscope {

/// A page about a run that needs nothing but itself: movie (or last picture), plots of the melt pool over
/// time, energy ledger, wall time, scenario, journal. What the folder does not hold is left out; what cannot
/// be read is told to `warn`.
std::string report_page(const RunPaths& paths, const std::function<void(const std::string&)>& warn);

} // namespace meltscope
