#pragma once

#include "viz/canvas.hpp"
#include "viz/data_sets.hpp"

#include <array>
#include <string>
#include <vector>

#include <vtkLookupTable.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace meltscope::viz {

/// One row of the plots of the dashboard.
struct HistoryPoint {
    double time = 0.0;   ///< s
    double length = 0.0; ///< m, of the pool shown
    double width = 0.0;  ///< m
    double depth = 0.0;  ///< m
    double power = 0.0;  ///< W, all beams together
    double peak = 0.0;   ///< K
};

HistoryPoint history_point(const Snapshot& snapshot);

/// Everything that the panels of one picture share.
struct Picture {
    const Instant* instant = nullptr;
    const std::vector<HistoryPoint>* history = nullptr;
    std::string field;                           ///< name of the field shown
    const std::vector<double>* values = nullptr; ///< its node values
    std::array<double, 2> range{};               ///< of the colours
    vtkSmartPointer<vtkLookupTable> colors;
    vtkSmartPointer<vtkPolyData> surface; ///< free surface with the field as scalars
    vtkSmartPointer<vtkPolyData> walls;   ///< the same on the domain's faces
    const Theme* theme = nullptr;
    std::array<int, 2> size{}; ///< pixels
    double font = 16.0;        ///< pixels, of ordinary text
    double line = 1.5;         ///< pixels, of ordinary lines
    double heading =
        0.0; ///< pixels above a panel that its heading takes, with room for a scale bar on the right
};

/// The pool whose size pictures tell: that of the beam they follow, else the largest; zero if there is none.
PoolFigures shown_pool(const Snapshot& snapshot);
/// The beam that pictures follow: the first that is on, else the first; null without any.
const BeamSnapshot* leading_beam(const Snapshot& snapshot);
/// Where a beam meets the material, m.
Vec3 spot_center(const BeamSnapshot& beam, const Geometry& geometry);
/// The scan direction in the plane; x while the beam dwells.
Vec3 track_direction(const BeamSnapshot* beam);

} // namespace meltscope::viz
