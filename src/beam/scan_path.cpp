#include "meltscope/beam/scan_path.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace meltscope {

namespace {

using Kind = PathSegment::Kind;

const Vec3& segment_start(const ScanPath& path, std::size_t index) {
    return index == 0 ? path.start : path.segments[index - 1].end;
}

/// The segment in force at `time`: the first that ends after it; the number of segments if none does.
std::size_t segment_at(const std::vector<double>& end_times, double time) {
    return static_cast<std::size_t>(std::upper_bound(end_times.begin(), end_times.end(), time) -
                                    end_times.begin());
}

void check_speed(double speed) {
    if (!(std::isfinite(speed) && speed > 0.0)) {
        throw PathError(fmt::format("the speed of a line must be above zero, not {} m/s", speed));
    }
}

void check_power(const std::optional<double>& power) {
    if (power && !(std::isfinite(*power) && *power >= 0.0)) {
        throw PathError(fmt::format("the power must be zero or more, not {} W", *power));
    }
}

/// `start` is where the beam is before the segment.
void check_segment(const PathSegment& segment, const Vec3& start) {
    if (!segment.end.allFinite()) {
        throw PathError("the coordinates must be finite numbers");
    }
    check_power(segment.power);
    if (segment.kind == Kind::line) {
        check_speed(segment.speed);
        if (!((segment.end - start).norm() > 0.0)) {
            throw PathError("a line must have a length: it ends where it begins");
        }
    } else if (!(std::isfinite(segment.duration) && segment.duration >= 0.0)) {
        throw PathError(fmt::format("a dwell must last zero or more, not {} s", segment.duration));
    }
}

} // namespace

std::vector<double> segment_end_times(const ScanPath& path) {
    std::vector<double> end_times;
    end_times.reserve(path.segments.size());
    double time = path.start_time;
    Vec3 start = path.start;
    for (const PathSegment& segment : path.segments) {
        time += segment.kind == Kind::line ? (segment.end - start).norm() / segment.speed : segment.duration;
        end_times.push_back(time);
        start = segment.end;
    }
    return end_times;
}

double path_end_time(const ScanPath& path) {
    return path.segments.empty() ? path.start_time : segment_end_times(path).back();
}

Vec3 path_end(const ScanPath& path) {
    return path.segments.empty() ? path.start : path.segments.back().end;
}

BeamPosition beam_at(const ScanPath& path, double time) {
    return beam_at(path, segment_end_times(path), time);
}

BeamPosition beam_at(const ScanPath& path, const std::vector<double>& end_times, double time) {
    BeamPosition beam;
    if (time < path.start_time) {
        beam.position = path.start;
        return beam;
    }
    const std::size_t index = segment_at(end_times, time);
    if (index == path.segments.size()) {
        beam.position = path_end(path);
        beam.finished = true;
        return beam;
    }
    const PathSegment& segment = path.segments[index];
    beam.power = segment.power;
    beam.on = segment.laser_on;
    if (segment.kind == Kind::dwell) {
        beam.position = segment.end;
        return beam;
    }
    const Vec3& start = segment_start(path, index);
    const double begin_time = index == 0 ? path.start_time : end_times[index - 1];
    const double share = (time - begin_time) / (end_times[index] - begin_time);
    beam.position = start + share * (segment.end - start);
    beam.scan_direction = (segment.end - start).normalized();
    beam.speed = segment.speed;
    return beam;
}

std::optional<double> next_corner_time(const ScanPath& path, double time) {
    if (time < path.start_time) {
        return path.start_time;
    }
    const std::vector<double> end_times = segment_end_times(path);
    const std::size_t index = segment_at(end_times, time);
    return index == end_times.size() ? std::nullopt : std::optional<double>(end_times[index]);
}

PathCorners corners_at(const ScanPath& path, double time) {
    const std::vector<double> end_times = segment_end_times(path);
    const auto add = [](std::vector<PathCorner>& corners, const Vec3& position, bool lit) {
        if (corners.empty() || corners.back().position != position) {
            corners.push_back({position, lit});
        }
    };
    const auto lit = [&](std::size_t i) {
        const PathSegment& segment = path.segments[i];
        return segment.kind == Kind::line && segment.laser_on && segment.power.value_or(1.0) > 0.0;
    };
    PathCorners corners;
    corners.done = path.passed;
    add(corners.done, path.start, true);
    const std::size_t index = time < path.start_time ? 0 : segment_at(end_times, time);
    for (std::size_t i = 0; i < index; ++i) {
        add(corners.done, path.segments[i].end, lit(i));
    }
    const Vec3 position = beam_at(path, end_times, time).position;
    add(corners.done, position, index < path.segments.size() && lit(index));
    add(corners.to_come, position, true);
    for (std::size_t i = index; i < path.segments.size(); ++i) {
        add(corners.to_come, path.segments[i].end, lit(i));
    }
    return corners;
}

void check_path(const ScanPath& path) {
    if (!path.start.allFinite() || !std::isfinite(path.start_time)) {
        throw PathError("a path must start at a finite place and time");
    }
    for (std::size_t i = 0; i < path.segments.size(); ++i) {
        try {
            check_segment(path.segments[i], segment_start(path, i));
        } catch (const PathError& error) {
            throw PathError(fmt::format("path segment {}: {}", i + 1, error.what()));
        }
    }
    if (!std::isfinite(path_end_time(path))) {
        throw PathError("the path takes longer than a number can hold");
    }
}

void append_line(ScanPath& path, const Vec3& to, double speed, std::optional<double> power, bool laser_on) {
    const PathSegment line{Kind::line, to, speed, 0.0, power, laser_on};
    check_segment(line, path_end(path));
    path.segments.push_back(line);
}

void append_dwell(ScanPath& path, double duration, std::optional<double> power, bool laser_on) {
    if (!(duration > 0.0)) {
        throw PathError(fmt::format("a dwell must last longer than zero, not {} s", duration));
    }
    const PathSegment dwell{Kind::dwell, path_end(path), 0.0, duration, power, laser_on};
    check_segment(dwell, dwell.end);
    path.segments.push_back(dwell);
}

void append_jump(ScanPath& path, const Vec3& to, std::optional<double> speed) {
    if (to == path_end(path)) {
        return;
    }
    if (speed) {
        append_line(path, to, *speed, {}, false);
        return;
    }
    const PathSegment jump{Kind::dwell, to, 0.0, 0.0, {}, false};
    check_segment(jump, to);
    path.segments.push_back(jump);
}

void append_path(ScanPath& path, const ScanPath& more) {
    append_jump(path, more.start);
    path.segments.insert(path.segments.end(), more.segments.begin(), more.segments.end());
}

ScanPath path_from(const ScanPath& path, double time) {
    if (time < path.start_time) {
        return path;
    }
    const std::vector<double> end_times = segment_end_times(path);
    const std::size_t index = segment_at(end_times, time);
    ScanPath rest;
    rest.start = beam_at(path, end_times, time).position;
    rest.start_time = time;
    rest.passed = corners_at(path, time).done; // the last is where the rest starts
    rest.segments.assign(path.segments.begin() + static_cast<std::ptrdiff_t>(index), path.segments.end());
    if (rest.segments.empty()) {
        return rest;
    }
    PathSegment& first = rest.segments.front();
    if (first.kind == Kind::dwell) {
        first.duration = end_times[index] - time;
    } else if (first.end == rest.start) { // cut within rounding of the line's end
        rest.segments.erase(rest.segments.begin());
    }
    return rest;
}

ScanPath path_cut_at(const ScanPath& path, double time) {
    ScanPath rest = path_from(path, time);
    rest.start_time = time;
    rest.segments.clear();
    return rest;
}

ScanPath with_speed_from(const ScanPath& path, double time, double speed) {
    check_speed(speed);
    ScanPath rest = path_from(path, time);
    for (PathSegment& segment : rest.segments) {
        if (segment.kind == Kind::line && segment.laser_on) {
            segment.speed = speed;
        }
    }
    return rest;
}

ScanPath with_power_from(const ScanPath& path, double time, std::optional<double> power) {
    check_power(power);
    ScanPath rest = path_from(path, time);
    for (PathSegment& segment : rest.segments) {
        if (segment.laser_on) {
            segment.power = power;
        }
    }
    return rest;
}

} // namespace meltscope
