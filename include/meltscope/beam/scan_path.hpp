#pragma once

#include "meltscope/vec3.hpp"

#include <optional>
#include <string>
#include <vector>

namespace meltscope {

/// One piece of a scan path: a straight line run at constant speed, or a dwell.
struct PathSegment {
    enum class Kind { line, dwell };
    Kind kind = Kind::line;
    Vec3 end = Vec3::Zero();            ///< m, where the beam is at the end of the segment
    double speed = 0.0;                 ///< m/s, of a line
    double duration = 0.0;              ///< s, of a dwell
    std::optional<double> power;        ///< W, for this segment; otherwise the laser's own power
    bool laser_on = true;               ///< off while jumping between hatches (skywriting)
};

/// Where a beam is and what it does at one instant.
struct BeamPosition {
    Vec3 position = Vec3::Zero();       ///< m
    Vec3 scan_direction = Vec3::Zero(); ///< unit; zero in a dwell and after the end
    double speed = 0.0;                 ///< m/s
    std::optional<double> power;        ///< W, if the segment sets one
    bool on = false;                    ///< false where the segment is off and after the end
    bool finished = false;              ///< the path has ended
};

/// The path of one beam: a start point and time, then segments. A plain value; a checkpoint can hold it.
struct ScanPath {
    Vec3 start = Vec3::Zero();          ///< m
    double start_time = 0.0;            ///< s
    std::vector<PathSegment> segments;
};

} // namespace meltscope
