#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace meltscope {

/// The candidate most like `word` (fewest letters inserted, deleted, changed or swapped with their neighbour,
/// case ignored), for "did you mean"; empty if none is near enough to be meant.
std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

} // namespace meltscope
