#pragma once

#include "meltscope/beam/scan_path.hpp"

#include <filesystem>
#include <optional>
#include <string_view>

namespace meltscope {

/// Path files have a header line, then rows `Mode X Y Z Power Param` parted by blanks or tabs.
/// Mode 1 puts the beam at X Y Z and keeps it there for Param seconds; mode 0 draws a line to X Y Z at Param
/// m/s. A first row of mode 1 gives the start point; a first row of mode 0 draws from the origin, as both
/// programs do.
enum class PathFileFormat {
    additivefoam, ///< metres; Power in watts (AdditiveFOAM and Finch, Oak Ridge National Laboratory)
    threedthesis, ///< millimetres; Power is a factor on the laser's power (3DThesis, the same laboratory)
};

/// Reads a path file. Rows of no power are segments without light. In a 3DThesis file a factor of one leaves
/// the segment to the laser's own power; any other factor needs `laser_power` (W). Throws PathError with
/// file:line:column for what cannot be read or run.
ScanPath read_path_file(const std::filesystem::path& file, PathFileFormat format,
                        std::optional<double> laser_power = {});

/// The same from text; `name` stands for the file in messages.
ScanPath parse_path_text(std::string_view text, std::string_view name, PathFileFormat format,
                         std::optional<double> laser_power = {});

} // namespace meltscope
