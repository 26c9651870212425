#pragma once

#include "meltscope/beam/scan_path.hpp"

#include <string>

namespace meltscope {

enum class BeamProfile { gaussian, top_hat, super_gaussian, volumetric };

/// A laser: what it emits and the path it follows. A plain value; a checkpoint can hold it.
struct Laser {
    std::string name = "laser";
    double power = 0.0;        ///< W, of segments that set none
    double absorptivity = 0.0; ///< 1, in [0, 1]
    double spot_radius = 0.0;  ///< m, 1/e^2 radius (half of D4sigma for a Gaussian)
    BeamProfile profile = BeamProfile::gaussian;
    double super_gaussian_order = 4.0; ///< exponent k of exp(-2 (r/R)^k)
    double volume_depth = 0.0;         ///< m, 1/e^2 depth of the volumetric source
    double volume_width = 0.0;         ///< m, its 1/e^2 radius across the scan direction; zero: spot_radius
    Vec3 direction{0.0, 0.0, -1.0};    ///< unit, the way the light travels
    bool on = true;
    ScanPath path;
};

} // namespace meltscope
