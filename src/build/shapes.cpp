#include "meltscope/build/shapes.hpp"

#include "mesh_section.hpp"
#include "row_interval.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <string_view>

namespace meltscope {

namespace {

void require_positive(double value, std::string_view what) {
    if (!(std::isfinite(value) && value > 0.0)) {
        throw GeometryError(fmt::format("{} must be above zero, not {} m", what, value));
    }
}

void require_finite(const Vec3& value, std::string_view what) {
    if (!value.allFinite()) {
        throw GeometryError(fmt::format("{} must be finite numbers", what));
    }
}

void check(const Box& box) {
    require_finite(box.min, "the corners of a box");
    require_finite(box.max, "the corners of a box");
    for (int axis = 0; axis < 3; ++axis) {
        require_positive(box.max[axis] - box.min[axis],
                         fmt::format("the length of a box along {}", "xyz"[axis]));
    }
}

void check(const Sphere& sphere) {
    require_finite(sphere.center, "the centre of a sphere");
    require_positive(sphere.radius, "the radius of a sphere");
}

void check(const Cylinder& cylinder) {
    require_finite(cylinder.base, "the base of a cylinder");
    require_finite(cylinder.axis, "the axis of a cylinder");
    require_positive(cylinder.axis.norm(), "the length of a cylinder's axis vector");
    require_positive(cylinder.radius, "the radius of a cylinder");
    require_positive(cylinder.height, "the height of a cylinder");
}

void check(const Balls& balls) {
    for (const Ball& ball : balls.balls) {
        check(ball);
    }
}

void check(const Solid& solid) {
    for (const Vec3& point : solid.points) {
        require_finite(point, "the points of a solid");
    }
    for (const auto& triangle : solid.triangles) {
        for (const std::uint32_t corner : triangle) {
            if (corner >= solid.points.size()) {
                throw GeometryError(
                    fmt::format("a triangle names point {} of {}", corner, solid.points.size()));
            }
        }
    }
}

Box bounds(const Box& box) {
    return box;
}

Box bounds(const Sphere& sphere) {
    const Vec3 reach = Vec3::Constant(sphere.radius);
    return {sphere.center - reach, sphere.center + reach};
}

Box bounds(const Cylinder& cylinder) {
    const Vec3 axis = cylinder.axis.normalized();
    const Vec3 top = cylinder.base + cylinder.height * axis;
    // A disc across `axis` reaches radius sqrt(1 - axis_i^2) along direction i.
    const Vec3 reach = cylinder.radius * (1.0 - axis.array().square()).max(0.0).sqrt().matrix();
    return {cylinder.base.cwiseMin(top) - reach, cylinder.base.cwiseMax(top) + reach};
}

constexpr double infinite = std::numeric_limits<double>::infinity();

Box bounds(const Balls& balls) {
    Box box{Vec3::Constant(infinite), Vec3::Constant(-infinite)};
    for (const Ball& ball : balls.balls) {
        const Box one = bounds(ball);
        box = {box.min.cwiseMin(one.min), box.max.cwiseMax(one.max)};
    }
    return box;
}

Box bounds(const Solid& solid) {
    Box box{Vec3::Constant(infinite), Vec3::Constant(-infinite)};
    for (const Vec3& point : solid.points) {
        box = {box.min.cwiseMin(point), box.max.cwiseMax(point)};
    }
    return box;
}

bool holds(const RowInterval& interval, double x) {
    return interval.begin <= x && x < interval.end;
}

template <class Simple>
bool has(const Simple& shape, const Vec3& point) {
    return holds(row_interval(shape, point.y(), point.z()), point.x());
}

bool has(const Balls& balls, const Vec3& point) {
    for (const Ball& ball : balls.balls) {
        if (has(ball, point)) {
            return true;
        }
    }
    return false;
}

bool has(const Solid& solid, const Vec3& point) {
    std::vector<std::uint32_t> all(solid.triangles.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i] = static_cast<std::uint32_t>(i);
    }
    const std::vector<SectionEdge> section = cut_mesh(solid, all, point.z());
    std::vector<MeshCrossing> crossings;
    for (const RowInterval& interval : row_intervals(section, point.y(), crossings)) {
        if (holds(interval, point.x())) {
            return true;
        }
    }
    return false;
}

} // namespace

Box bounding_box(const Shape& shape) {
    return std::visit([](const auto& one) { return bounds(one); }, shape);
}

bool contains(const Shape& shape, const Vec3& point) {
    return std::visit([&](const auto& one) { return has(one, point); }, shape);
}

void check_shape(const Shape& shape) {
    std::visit([](const auto& one) { check(one); }, shape);
}

} // namespace meltscope
