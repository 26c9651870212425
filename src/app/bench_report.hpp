#pragma once

#include "bench_measure.hpp"

#include <string>
#include <vector>

namespace meltscope {

/// The figures as JSON: at the top those of the first scene's first form, then all under `scenes`.
std::string bench_json(const std::vector<SceneFigures>& scenes);

/// The figures for people to read.
std::string bench_text(const std::vector<SceneFigures>& scenes);

} // namespace meltscope
