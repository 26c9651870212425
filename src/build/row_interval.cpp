#include "row_interval.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope {

RowInterval row_interval(const Box& box, double y, double z) {
    if (y < box.min.y() || y >= box.max.y() || z < box.min.z() || z >= box.max.z()) {
        return {};
    }
    return {box.min.x(), box.max.x()};
}

RowInterval row_interval(const Sphere& sphere, double y, double z) {
    const double dy = y - sphere.center.y();
    const double dz = z - sphere.center.z();
    const double square = sphere.radius * sphere.radius - dy * dy - dz * dz;
    if (!(square > 0.0)) {
        return {};
    }
    const double half = std::sqrt(square);
    return {sphere.center.x() - half, sphere.center.x() + half};
}

RowInterval row_interval(const Cylinder& cylinder, double y, double z) {
    const Vec3 axis = cylinder.axis.normalized();
    const Vec3 offset(0.0, y - cylinder.base.y(), z - cylinder.base.z()); // row's point at the base's x
    constexpr double infinite = std::numeric_limits<double>::infinity();
    RowInterval interval{-infinite, infinite};

    // Between the ends: 0 <= height along the axis = offset.axis + t axis_x < height, t = x - base_x.
    const double along = offset.dot(axis);
    if (axis.x() == 0.0) {
        if (along < 0.0 || along >= cylinder.height) {
            return {};
        }
    } else {
        const double at_base = -along / axis.x();
        const double at_top = (cylinder.height - along) / axis.x();
        interval = {std::min(at_base, at_top), std::max(at_base, at_top)};
    }

    // Within the radius: |offset_r + t x_r|^2 < radius^2, the parts across the axis.
    const Vec3 offset_across = offset - along * axis;
    const Vec3 x_across = Vec3::UnitX() - axis.x() * axis;
    const double a = x_across.squaredNorm();
    const double half_b = offset_across.dot(x_across);
    const double c = offset_across.squaredNorm() - cylinder.radius * cylinder.radius;
    if (a < 1e-24) { // the row runs along the axis
        if (c >= 0.0) {
            return {};
        }
    } else {
        const double discriminant = half_b * half_b - a * c;
        if (!(discriminant > 0.0)) {
            return {};
        }
        const double root = std::sqrt(discriminant);
        interval.begin = std::max(interval.begin, (-half_b - root) / a);
        interval.end = std::min(interval.end, (-half_b + root) / a);
    }
    return {cylinder.base.x() + interval.begin, cylinder.base.x() + interval.end};
}

} // namespace meltscope
