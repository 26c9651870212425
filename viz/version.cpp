#include "viz/version.hpp"

#include <vtkVersion.h>

namespace meltscope::viz {

std::string vtk_version() {
    return vtkVersion::GetVTKVersion();
}

} // namespace meltscope::viz
