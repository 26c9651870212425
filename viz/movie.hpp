#pragma once

#include "viz/options.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace meltscope::viz {

/// The views that have pictures VIEW_NNNNNN.png in a folder, sorted by name.
std::vector<std::string> views_with_frames(const std::filesystem::path& frames_dir);

/// Makes `mp4` (H.264, yuv420p, +faststart) from the pictures VIEW_*.png in order of their numbers, gaps
/// allowed, `fps` pictures a second. Odd sizes are padded to even ones. Returns false if there is no picture
/// of that view; throws VizError if ffmpeg is missing or fails, with its last words.
bool encode_movie(const std::filesystem::path& frames_dir, const std::string& view,
                  const std::filesystem::path& mp4, double fps = 25.0);

} // namespace meltscope::viz
