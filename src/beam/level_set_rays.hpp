#pragma once

#include "meltscope/aligned.hpp"
#include "meltscope/mpm/grid.hpp"

namespace meltscope {

/// Distance along the ray to the first interface, infinite if it meets none. phi is a distance, so that steps
/// of its size cannot jump over material.
double first_interface(const Grid& grid, const Field& phi, const Vec3& start, const Vec3& direction);

} // namespace meltscope
