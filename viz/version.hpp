#pragma once

#include <string>

namespace meltscope::viz {

/// Version of the VTK library in use, such as "9.1.0".
std::string vtk_version();

} // namespace meltscope::viz
