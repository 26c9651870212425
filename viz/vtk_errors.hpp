#pragma once

#include <string>

namespace meltscope::viz {

/// Collects what VTK would print on the terminal, from now to the end of the process. Safe to call again.
void capture_vtk_errors();

/// The first error since the last call, one line; empty if there was none.
std::string take_vtk_error();

} // namespace meltscope::viz
