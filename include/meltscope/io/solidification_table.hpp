#pragma once

#include "meltscope/run/solidified_point.hpp"

#include <filesystem>
#include <span>

namespace meltscope {

/// Writes points as the table that ExaCA reads: header `x,y,z,tm,tl,cr`, then a row a point, in m, s and K/s.
/// The file appears whole or not at all. Throws std::system_error.
void write_solidification_table(const std::filesystem::path& path, std::span<const SolidifiedPoint> points);

} // namespace meltscope
