#pragma once

#include "meltscope/vec3.hpp"

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace meltscope {

/// A path that cannot be run, or a path file that cannot be read.
struct PathError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// One piece of a scan path: a straight line run at constant speed, or a dwell at `end`.
/// A dwell whose `end` is not where the beam is begins with an instantaneous jump; the functions below
/// write a jump as a dwell of no duration.
struct PathSegment {
    enum class Kind { line, dwell };
    Kind kind = Kind::line;
    Vec3 end = Vec3::Zero();     ///< m, where the beam is at the end of the segment
    double speed = 0.0;          ///< m/s, of a line
    double duration = 0.0;       ///< s, of a dwell
    std::optional<double> power; ///< W, for this segment; otherwise the laser's own power
    bool laser_on = true;        ///< off while jumping between hatches (skywriting)

    bool operator==(const PathSegment&) const = default;
};

/// Where a beam is and what it does at one instant.
struct BeamPosition {
    Vec3 position = Vec3::Zero();       ///< m
    Vec3 scan_direction = Vec3::Zero(); ///< unit; zero in a dwell and after the end
    double speed = 0.0;                 ///< m/s
    std::optional<double> power;        ///< W, if the segment sets one
    bool on = false;                    ///< false before the start, where the segment is off, after the end
    bool finished = false;              ///< the path has ended
};

/// A corner of a path as it is drawn.
struct PathCorner {
    Vec3 position = Vec3::Zero(); ///< m
    bool lit = true;              ///< the way here from the corner before is run with light

    bool operator==(const PathCorner&) const = default;
};

/// The path of one beam: a start point and time, then segments. A plain value; a checkpoint can hold it.
struct ScanPath {
    Vec3 start = Vec3::Zero(); ///< m
    double start_time = 0.0;   ///< s
    std::vector<PathSegment> segments;
    /// Corners run up to `start` by a path that was edited under way; pictures show them, nothing else uses
    /// them.
    std::vector<PathCorner> passed;

    bool operator==(const ScanPath&) const = default;
};

/// Time at which each segment ends, s. The one place where times are made: sums from start_time on, in order,
/// so that they depend on the path alone.
std::vector<double> segment_end_times(const ScanPath& path);

/// Time at which the whole path has been run, s.
double path_end_time(const ScanPath& path);

/// Where the path ends, m.
Vec3 path_end(const ScanPath& path);

/// The beam at `time` (s). Segment i rules over [end of i-1, end of i), so that at a corner the segment that
/// begins there is the one in force. Lines are interpolated between their end points; these are met exactly.
BeamPosition beam_at(const ScanPath& path, double time);

/// The same with the times at hand, for callers that ask often; `end_times` is segment_end_times(path).
BeamPosition beam_at(const ScanPath& path, const std::vector<double>& end_times, double time);

/// The first instant strictly after `time` at which a segment begins or ends; none after the path's end.
std::optional<double> next_corner_time(const ScanPath& path, double time);

/// Corners run before a time and still to come: `done` ends and `to_come` begins where the beam is. Jumps and
/// lines without power are run without light, whatever the laser's own switch says.
struct PathCorners {
    std::vector<PathCorner> done;
    std::vector<PathCorner> to_come;
};
PathCorners corners_at(const ScanPath& path, double time);

/// Throws PathError, naming the segment, unless all values are finite, lines have length and speed, dwells
/// are not negative, powers are not negative and the path ends at a finite time.
void check_path(const ScanPath& path);

/// Appends a line from the path's end to `to` (m). Throws PathError for no length or a speed not above zero.
void append_line(ScanPath& path, const Vec3& to, double speed, std::optional<double> power = {},
                 bool laser_on = true);
/// Appends a stay of `duration` (s) at the path's end. Throws PathError unless the duration is above zero.
void append_dwell(ScanPath& path, double duration, std::optional<double> power = {}, bool laser_on = true);
/// Appends a move without light: at `speed` (m/s), or at once without one. No-op if the path ends at `to`.
void append_jump(ScanPath& path, const Vec3& to, std::optional<double> speed = {});
/// Appends all segments of `more`, after a jump to its start where that is elsewhere; its times are not used.
void append_path(ScanPath& path, const ScanPath& more);

/// The path as it is still to be run at `time`: it starts there and then, at the very position beam_at gives.
/// What follows `append_...` therefore begins at `time` even if the old path has ended before.
ScanPath path_from(const ScanPath& path, double time);
/// The same with all segments dropped: the beam stays where it is, without light.
ScanPath path_cut_at(const ScanPath& path, double time);
/// path_from with a new speed (m/s) for every line with light. Throws PathError unless it is above zero.
ScanPath with_speed_from(const ScanPath& path, double time, double speed);
/// path_from with a power (W) for every segment with light; none gives them back to the laser's own power.
ScanPath with_power_from(const ScanPath& path, double time, std::optional<double> power);

} // namespace meltscope
