#include "meltscope/beam/pattern.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace meltscope {

namespace {

using Vec2 = Eigen::Vector2d;

constexpr double max_lines = 1e7;

/// Relative measure below which a length counts as none, so that rounding makes no extra line or island.
constexpr double rounding = 1e-9;

void require(bool good, std::string_view what, double value) {
    if (!good) {
        throw PathError(fmt::format("pattern: {}, not {}", what, value));
    }
}

void check_raster(const RasterSpec& spec) {
    const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
    require(spec.min.allFinite() && positive(spec.max.x() - spec.min.x()),
            "the rectangle's length along x must be above zero", spec.max.x() - spec.min.x());
    require(positive(spec.max.y() - spec.min.y()), "the rectangle's length along y must be above zero",
            spec.max.y() - spec.min.y());
    require(positive(spec.hatch), "the hatch spacing must be above zero", spec.hatch);
    require(positive(spec.speed), "the speed must be above zero", spec.speed);
    require(std::isfinite(spec.z), "the height must be a finite number", spec.z);
    require(std::isfinite(spec.angle), "the angle must be a finite number", spec.angle);
    require(std::isfinite(spec.start_time), "the start time must be a finite number", spec.start_time);
    require(std::isfinite(spec.turn_time) && spec.turn_time >= 0.0, "the turn time must be zero or more",
            spec.turn_time);
    if (spec.power) {
        require(std::isfinite(*spec.power) && *spec.power >= 0.0, "the power must be zero or more",
                *spec.power);
    }
}

/// How many pieces of `size` fit into `length`, at least one.
double pieces(double length, double size) {
    return std::max(1.0, std::floor(length / size + rounding));
}

/// Sine and cosine of which rounding does not turn lines along an axis into slanted ones.
Vec2 direction_of(double angle) {
    Vec2 direction(std::cos(angle), std::sin(angle));
    for (double& component : direction) {
        if (std::abs(component) < 1e-15) {
            component = 0.0;
        }
    }
    return direction.normalized();
}

/// The part of the line point + t direction that lies in the rectangle, its ends exactly on the edges.
/// False if the line misses the rectangle or only touches it.
bool clip(const Vec2& point, const Vec2& direction, const Vec2& min, const Vec2& max, Vec2& begin,
          Vec2& end) {
    double enter = -HUGE_VAL;
    double leave = HUGE_VAL;
    int enter_axis = 0;
    int leave_axis = 0;
    for (int axis = 0; axis < 2; ++axis) {
        if (direction[axis] == 0.0) {
            if (point[axis] < min[axis] || point[axis] > max[axis]) {
                return false;
            }
            continue;
        }
        const bool forward = direction[axis] > 0.0;
        const double near = ((forward ? min : max)[axis] - point[axis]) / direction[axis];
        const double far = ((forward ? max : min)[axis] - point[axis]) / direction[axis];
        if (near > enter) {
            enter = near;
            enter_axis = axis;
        }
        if (far < leave) {
            leave = far;
            leave_axis = axis;
        }
    }
    if (!(leave - enter > rounding * (max - min).norm())) {
        return false;
    }
    const auto on_edge = [&](double parameter, int axis, bool upper) {
        Vec2 corner = (point + parameter * direction).cwiseMax(min).cwiseMin(max);
        corner[axis] = (upper ? max : min)[axis];
        return corner;
    };
    begin = on_edge(enter, enter_axis, direction[enter_axis] < 0.0);
    end = on_edge(leave, leave_axis, direction[leave_axis] > 0.0);
    return true;
}

/// Appends the hatch of one rectangle. With `joined`, the path comes from another rectangle and turns first.
void append_raster(ScanPath& path, const RasterSpec& spec, bool joined) {
    const Vec2 along = direction_of(spec.angle);
    const Vec2 across(-along.y(), along.x());
    const Vec2 center = 0.5 * (spec.min + spec.max);
    const Vec2 size = spec.max - spec.min;
    const double width = size.x() * std::abs(across.x()) + size.y() * std::abs(across.y());
    const double count = pieces(width, spec.hatch);
    bool backwards = false;
    for (double i = 0.0; i < count; i += 1.0) {
        const Vec2 point = center + (i - 0.5 * (count - 1.0)) * spec.hatch * across;
        Vec2 begin;
        Vec2 end;
        if (!clip(point, along, spec.min, spec.max, begin, end)) {
            continue;
        }
        if (backwards) {
            std::swap(begin, end);
        }
        const Vec3 from(begin.x(), begin.y(), spec.z);
        const Vec3 to(end.x(), end.y(), spec.z);
        if (!joined) {
            path.start = from;
        } else if (spec.turn_time > 0.0 && from != path_end(path)) {
            append_line(path, from, (from - path_end(path)).norm() / spec.turn_time, {}, false);
        } else if (spec.turn_time > 0.0) {
            append_dwell(path, spec.turn_time, {}, false);
        } else {
            append_jump(path, from);
        }
        append_line(path, to, spec.speed, spec.power);
        joined = true;
        backwards = spec.bidirectional && !backwards;
    }
}

/// A whole number below `bound`, drawn without bias and the same with every standard library.
std::size_t draw_below(std::mt19937_64& generator, std::size_t bound) {
    const std::uint64_t limit = generator.max() - generator.max() % bound;
    std::uint64_t drawn = generator();
    while (drawn >= limit) {
        drawn = generator();
    }
    return static_cast<std::size_t>(drawn % bound);
}

template <class Spec>
RasterSpec& raster_of(Spec& spec) {
    if constexpr (std::is_same_v<Spec, IslandSpec>) {
        return spec.raster;
    } else {
        return spec;
    }
}

template <class Spec, class Make>
ScanPath make_layers(Spec spec, const LayerSpec& layers, Make make_layer) {
    require(layers.count >= 1, "the number of layers must be one or more", layers.count);
    require(std::isfinite(layers.thickness) && layers.thickness >= 0.0,
            "the layers' thickness must be zero or more", layers.thickness);
    require(std::isfinite(layers.rotation), "the rotation must be a finite number", layers.rotation);
    require(std::isfinite(layers.pause) && layers.pause >= 0.0, "the pause must be zero or more",
            layers.pause);
    const RasterSpec first = raster_of(spec);
    ScanPath path = make_layer(spec);
    const double lines = static_cast<double>(path.segments.size()) * layers.count;
    require(lines <= 2.0 * max_lines, "the layers must have no more than twenty million segments", lines);
    for (int i = 1; i < layers.count; ++i) {
        raster_of(spec).angle = first.angle + i * layers.rotation;
        raster_of(spec).z = first.z + i * layers.thickness;
        if constexpr (std::is_same_v<Spec, IslandSpec>) {
            ++spec.seed;
        }
        if (layers.pause > 0.0) {
            append_dwell(path, layers.pause, {}, false);
        }
        append_path(path, make_layer(spec));
    }
    return path;
}

} // namespace

ScanPath make_raster(const RasterSpec& spec) {
    check_raster(spec);
    const double lines = (spec.max - spec.min).sum() / spec.hatch;
    require(lines <= max_lines, "there must be no more than ten million lines", lines);
    ScanPath path;
    path.start_time = spec.start_time;
    append_raster(path, spec, false);
    check_path(path);
    return path;
}

ScanPath make_island(const IslandSpec& spec) {
    check_raster(spec.raster);
    require(std::isfinite(spec.island_size) && spec.island_size > 0.0, "the island size must be above zero",
            spec.island_size);
    require(std::isfinite(spec.island_rotation), "the islands' rotation must be a finite number",
            spec.island_rotation);
    const Vec2 size = spec.raster.max - spec.raster.min;
    const double columns = std::ceil(size.x() / spec.island_size - rounding);
    const double rows = std::ceil(size.y() / spec.island_size - rounding);
    const double lines = columns * rows * (2.0 * spec.island_size / spec.raster.hatch + 1.0);
    require(lines <= max_lines, "there must be no more than ten million lines", lines);

    std::vector<std::size_t> order(static_cast<std::size_t>(columns * rows));
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::mt19937_64 generator(spec.seed);
    for (std::size_t left = order.size(); left > 1; --left) { // Fisher and Yates
        std::swap(order[left - 1], order[draw_below(generator, left)]);
    }

    ScanPath path;
    path.start_time = spec.raster.start_time;
    bool joined = false;
    for (const std::size_t island : order) {
        const auto in_row = static_cast<std::size_t>(columns);
        const std::size_t row = island / in_row;
        const Vec2 place(static_cast<double>(island % in_row), static_cast<double>(row));
        RasterSpec raster = spec.raster;
        raster.min = spec.raster.min + spec.island_size * place;
        raster.max = spec.raster.min + spec.island_size * (place + Vec2::Ones());
        raster.max = raster.max.cwiseMin(spec.raster.max);
        if ((row + island % in_row) % 2 == 1) {
            raster.angle += spec.island_rotation;
        }
        append_raster(path, raster, joined);
        joined = true;
    }
    check_path(path);
    return path;
}

ScanPath make_raster_layers(const RasterSpec& spec, const LayerSpec& layers) {
    return make_layers(spec, layers, make_raster);
}

ScanPath make_island_layers(const IslandSpec& spec, const LayerSpec& layers) {
    return make_layers(spec, layers, make_island);
}

} // namespace meltscope
