#pragma once

#include "meltscope/scenario/scenario.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace meltscope {

/// A block of IN625 twice as long as wide and deep, under a laser, radiating; about so many particles. All
/// else by default, but that no part of it sleeps; `overrides`: KEY=VALUE.
Scenario bench_block(std::int64_t particles, const std::vector<std::string>& overrides);

/// A layer of resolved powder balls on a plate, both of IN625, under a laser, radiating; about so many
/// particles. The cell size follows from their number, so the same balls are packed for any.
Scenario bench_powder(std::int64_t particles, const std::vector<std::string>& overrides);

} // namespace meltscope
