#pragma once

#include "meltscope/build/shapes.hpp"

#include <filesystem>
#include <string_view>

namespace meltscope {

/// Reads an STL file, binary or ASCII; its coordinates times `scale` are metres. Points of equal
/// coordinates are merged. A mesh that is inside out as a whole is turned. Throws GeometryError with the
/// reason for a file that is cut short, too long or malformed, and for a mesh that check_closed refuses.
Solid read_stl(const std::filesystem::path& file, double scale = 1.0);

/// The same from the file's bytes; `name` stands for the file in messages.
Solid parse_stl(std::string_view bytes, std::string_view name, double scale = 1.0);

/// Throws GeometryError unless every edge is shared by exactly two triangles that run along it in opposite
/// directions and every triangle has an area.
void check_closed(const Solid& solid);

/// Enclosed volume (m^3); negative if the triangles run clockwise seen from outside.
double volume(const Solid& solid);

} // namespace meltscope
