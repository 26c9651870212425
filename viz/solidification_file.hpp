#pragma once

#include "meltscope/run/solidified_point.hpp"

#include <filesystem>
#include <span>

namespace meltscope::viz {

/// Writes points as VTP (XML PolyData) with the point arrays G (K/m), R (m/s), cr (K/s), tm and tl (s).
/// Throws VizError.
void write_solidification_points(const std::filesystem::path& path, std::span<const SolidifiedPoint> points);

} // namespace meltscope::viz
