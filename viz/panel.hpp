#pragma once

#include "viz/canvas.hpp"
#include "viz/picture.hpp"

#include <memory>
#include <vector>

#include <vtkCamera.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

namespace meltscope::viz {

/// A part of a picture with a scene of its own. Scenes live as long as the run; update() brings one to an
/// instant.
class Panel {
  public:
    Panel();
    virtual ~Panel() = default;
    Panel(const Panel&) = delete;
    Panel& operator=(const Panel&) = delete;

    vtkRenderer* renderer() { return renderer_; }
    /// Lays the panel out in `area` and draws what belongs over it on the canvas.
    virtual void update(const Picture& picture, const Rect& area, Canvas& canvas) = 0;

  protected:
    void place(const Picture& picture, const Rect& area);
    /// What of an area the scene gets: a scale bar that does not fit beside a heading has a strip below.
    static Rect above_scale_bar(const Picture& picture, const Rect& area);
    /// Puts the bar where above_scale_bar() left room, with the given left end in a strip.
    static void place_scale_bar(const Picture& picture, const Rect& area, const Pixel& in_strip,
                                double pixels_per_metre, Canvas& canvas);
    /// Where a point of space lies in the picture; call after the camera is set.
    Pixel to_pixel(const Picture& picture, const Rect& area, const Vec3& point);
    vtkNew<vtkRenderer> renderer_;
};

std::unique_ptr<Panel> make_overview_panel();
std::unique_ptr<Panel> make_section_panel();
std::unique_ptr<Panel> make_top_panel();
std::unique_ptr<Panel> make_pool_panel();
std::unique_ptr<Panel> make_charts_panel();

/// Puts the camera so far away along -direction that all points just fill the panel.
void fit_camera(vtkCamera* camera, const std::vector<Vec3>& points, const Vec3& direction, const Vec3& up,
                double aspect);

} // namespace meltscope::viz
