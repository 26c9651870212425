#pragma once

#include "viz/picture.hpp"

#include <array>
#include <vector>

#include <vtkMatrix4x4.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace meltscope::viz {

/// The upright plane along the track through the laser, with coordinates s (along the scan direction, zero at
/// the spot) and z (height).
struct SectionPlane {
    Vec3 origin = Vec3::Zero(); ///< m, the spot on the surface
    Vec3 along = Vec3::UnitX(); ///< unit, horizontal

    Vec3 across() const { return Vec3::UnitZ().cross(along); } ///< unit, to the left of the scan direction
    Vec3 point(double s, double z) const {
        return {origin.x() + s * along.x(), origin.y() + s * along.y(), z};
    }
    /// Takes (s, z, 0) to space.
    vtkSmartPointer<vtkMatrix4x4> matrix() const;
};

SectionPlane track_plane(const Picture& picture);

/// The stretch of s inside the box of the domain, m.
std::array<double, 2> stretch_inside(const SectionPlane& plane, const NodeLattice& nodes);

/// A stretch of that width with the laser at `share` of it, moved, if need be, to lie inside.
std::array<double, 2> stretch_around(const SectionPlane& plane, const NodeLattice& nodes, double width,
                                     double share);

/// Height that a view of the plane keeps to: over powder, where the spot jumps from ball to ball, that of the
/// highest one, unless it is further off than `reach`, m.
double ground(const SectionPlane& plane, const Geometry& geometry, double reach);

/// The material in a window of the plane, as polygons at (s, z, 0) with the picture's field as scalars and
/// the array `temperature` and `boundary` (signed distance); window = s low, s high, z low, z high in m.
vtkSmartPointer<vtkPolyData> make_section(const Picture& picture, const SectionPlane& plane,
                                          const std::array<double, 4>& window);

/// Lines where an array of a section has the given values.
vtkSmartPointer<vtkPolyData> section_lines(vtkPolyData* section, const char* array,
                                           const std::vector<double>& values);

/// Where the free surface crosses the section.
vtkSmartPointer<vtkPolyData> section_surface(vtkPolyData* section, const NodeLattice& nodes);

/// What a view that follows the pool has to show; grows with the pool and never shrinks, so that pictures of
/// a movie keep their scale.
class PoolExtent {
  public:
    void update(const Picture& picture);
    double length = 0.0; ///< m
    double width = 0.0;  ///< m
    double depth = 0.0;  ///< m
};

} // namespace meltscope::viz
