#pragma once

#include "hot_regions.hpp"

#include <limits>
#include <vector>

namespace meltscope {

/// What a region is measured by. Its frame: along the scan direction, across it, up.
struct RegionMeasure {
    /// m, in its frame; high < low: it has no point in the material
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    double cells = 0.0;          ///< its volume, in cells
    Vec3 moment = Vec3::Zero();  ///< m, sum over the cells of share times place
    double peak = 0.0;           ///< K
    Vec3 hottest = Vec3::Zero(); ///< m, where the peak is

    void take(const Vec3& in_frame, const Vec3& point, double temperature) {
        low = low.cwiseMin(in_frame);
        high = high.cwiseMax(in_frame);
        if (temperature > peak) {
            peak = temperature;
            hottest = point;
        }
    }
};

/// Measures every region along the horizontal unit vector `scan`: places where the isotherm and the free
/// surface cut the edges and faces of cells, linear in between; volumes by sampling the cells cut.
std::vector<RegionMeasure> measure_regions(const HotRegions& regions, const NodeLattice& nodes,
                                           const std::vector<double>& temperature,
                                           const std::vector<double>& phi, double isotherm, const Vec3& scan);

} // namespace meltscope
