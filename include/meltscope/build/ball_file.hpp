#pragma once

#include "meltscope/build/shapes.hpp"

#include <filesystem>
#include <optional>
#include <string_view>

namespace meltscope {

/// Reads balls from rows `x,y,z,r` (m), as DEM codes write them; a header line may come first.
/// With a domain, a ball that lies wholly outside it is refused.
/// Throws GeometryError with file:line for what cannot be read, a radius not above zero or an empty list.
Balls read_ball_file(const std::filesystem::path& file, const std::optional<Box>& domain = {});

/// The same from text; `name` stands for the file in messages.
Balls parse_ball_text(std::string_view text, std::string_view name, const std::optional<Box>& domain = {});

} // namespace meltscope
