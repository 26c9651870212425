#pragma once

#include "meltscope/vec3.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <variant>
#include <vector>

namespace meltscope {

/// Geometry that cannot be read or built.
struct GeometryError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct Box {
    Vec3 min = Vec3::Zero(); ///< m
    Vec3 max = Vec3::Zero(); ///< m
};

struct Sphere {
    Vec3 center = Vec3::Zero(); ///< m
    double radius = 0.0;        ///< m
};

struct Cylinder {
    Vec3 base = Vec3::Zero();  ///< m, centre of the end from which the axis leaves
    Vec3 axis = Vec3::UnitZ(); ///< direction; its length does not matter
    double radius = 0.0;       ///< m
    double height = 0.0;       ///< m
};

using Ball = Sphere;

/// Any number of balls that make one body; they may overlap.
struct Balls {
    std::vector<Ball> balls;
};

/// The inside of a closed triangle mesh; read_stl makes one. Triangles run counter-clockwise seen from
/// outside.
struct Solid {
    std::vector<Vec3> points; ///< m
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

using Shape = std::variant<Box, Sphere, Cylinder, Balls, Solid>;

/// The smallest box around a shape; min > max for one without points.
Box bounding_box(const Shape& shape);

/// Whether a point (m) lies in the shape. Along x, the lower boundary belongs to the shape and the upper does
/// not (for boxes and solids along y and z too), so that shapes which abut neither share a point nor miss
/// one.
bool contains(const Shape& shape, const Vec3& point);

/// Throws GeometryError unless the numbers are finite, sizes above zero and indices valid.
void check_shape(const Shape& shape);

} // namespace meltscope
