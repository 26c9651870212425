#pragma once

#include "viz/picture.hpp"

#include <array>
#include <vector>

#include <vtkActor.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkRenderer.h>

namespace meltscope::viz {

/// A lit surface coloured by its scalars.
class SurfaceActor {
  public:
    explicit SurfaceActor(vtkRenderer* renderer);
    void update(vtkPolyData* surface, const Picture& picture);
    vtkActor* actor() { return actor_; }
    vtkPolyDataMapper* mapper() { return mapper_; }

  private:
    vtkNew<vtkActor> actor_;
    vtkNew<vtkPolyDataMapper> mapper_;
};

/// Lines of one colour, drawn over the surface they lie on.
class LineActor {
  public:
    explicit LineActor(vtkRenderer* renderer);
    void update(vtkPolyData* lines, const Rgb& color, double width, double opacity = 1.0);
    vtkActor* actor() { return actor_; }
    vtkPolyDataMapper* mapper() { return mapper_; }

  private:
    vtkNew<vtkActor> actor_;
    vtkNew<vtkPolyDataMapper> mapper_;
};

/// Lines through points, one cell a list.
vtkSmartPointer<vtkPolyData> make_lines(const std::vector<std::vector<Vec3>>& lines);

/// The edges of a box that face the viewer or not, all twelve.
vtkSmartPointer<vtkPolyData> make_box_edges(const Vec3& lower, const Vec3& upper);

/// What lies on the material: liquidus line, scan path (what is run without light thin and dim), beam spots
/// and beams.
class TrackActors {
  public:
    explicit TrackActors(vtkRenderer* renderer);
    /// `view_size`: what the view spans, m, for the length of dashes; `beam_height`: of the light above a
    /// spot, m, 0 for none.
    void update(const Picture& picture, double view_size, double beam_height);
    /// Shows the paths on one side of the plane only, which has to live as long.
    void clip_paths(vtkPlane* plane);

  private:
    LineActor moves_to_come_, moves_done_; ///< without light
    LineActor path_to_come_, path_done_;
    LineActor liquidus_;
    LineActor spots_;
    vtkNew<vtkActor> light_;
    vtkNew<vtkPolyDataMapper> light_mapper_;
};

} // namespace meltscope::viz
