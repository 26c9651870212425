#pragma once

#include <array>
#include <string_view>

namespace meltscope {

/// The arrays that /particles has in every checkpoint; whatever else is there is an extra array.
inline constexpr std::array<std::string_view, 6> particle_array_names{"position",        "mass", "volume",
                                                                      "specific_energy", "id",   "material"};

} // namespace meltscope
