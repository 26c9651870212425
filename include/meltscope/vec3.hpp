#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>

namespace meltscope {

/// A point or direction in space; metres where it is a length.
using Vec3 = Eigen::Vector3d;

/// Three counts or indices, x y z.
using Index3 = Eigen::Array<std::int64_t, 3, 1>;

} // namespace meltscope
