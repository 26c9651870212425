#pragma once

#include "meltscope/build/shapes.hpp"

namespace meltscope {

/// The stretch begin <= x < end (m) of a row parallel to x that lies in a shape; empty where begin >= end.
struct RowInterval {
    double begin = 0.0;
    double end = 0.0;
};

/// Convex shapes meet the row at y, z (m) in one stretch.
RowInterval row_interval(const Box& box, double y, double z);
RowInterval row_interval(const Sphere& sphere, double y, double z);
RowInterval row_interval(const Cylinder& cylinder, double y, double z);

} // namespace meltscope
