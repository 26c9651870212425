#pragma once

#include "meltscope/vec3.hpp"

namespace meltscope {

/// One solidification of one grid node: what codes of grain growth start from.
struct SolidifiedPoint {
    Vec3 position = Vec3::Zero(); ///< m, of the node
    double melted = 0.0;          ///< s, tm: when it passed the liquidus upwards; a start in the melt counts
    double solidified = 0.0;      ///< s, tl: when it passed the liquidus downwards
    double cooling_rate = 0.0;    ///< K/s, cr = -dT/dt at tl
    double gradient = 0.0;        ///< K/m, G = |grad T| at tl
    double speed = 0.0;           ///< m/s, R = cr/G, of the liquidus isotherm along the gradient
};

} // namespace meltscope
