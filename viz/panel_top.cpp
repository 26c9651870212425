#include "viz/actors.hpp"
#include "viz/panel.hpp"

#include <algorithm>

namespace meltscope::viz {

namespace {

/// The whole part from straight above, without perspective; the longer side lies across.
class TopPanel : public Panel {
  public:
    void update(const Picture& picture, const Rect& area, Canvas& canvas) override {
        const Rect scene = above_scale_bar(picture, area);
        place(picture, scene);
        surface_.update(picture.surface, picture);
        walls_.update(picture.walls, picture);

        const Geometry& geometry = *picture.instant->geometry;
        const Vec3 size = geometry.upper - geometry.lower;
        track_.update(picture, size.norm(), 0.0);
        const Vec3 center = 0.5 * (geometry.upper + geometry.lower);
        const bool turned = size.y() > size.x();
        const double across = std::max(size.x(), size.y());
        const double upright = std::min(size.x(), size.y());
        const double half_height = 0.5 * std::max(upright, across * scene.height / scene.width);
        vtkCamera* camera = renderer_->GetActiveCamera();
        camera->ParallelProjectionOn();
        camera->SetParallelScale(half_height);
        camera->SetFocalPoint(center.data());
        camera->SetPosition(center.x(), center.y(), geometry.upper.z() + across);
        if (turned) {
            camera->SetViewUp(-1.0, 0.0, 0.0);
        } else {
            camera->SetViewUp(0.0, 1.0, 0.0);
        }
        renderer_->ResetCameraClippingRange();

        const double pixels_per_metre = scene.height / (2.0 * half_height);
        const double left = scene.x + 0.5 * (scene.width - across * pixels_per_metre);
        const double bottom = scene.y + 0.5 * (scene.height - upright * pixels_per_metre);
        place_scale_bar(picture, area, {left, bottom - 1.2 * picture.font}, pixels_per_metre, canvas);
    }

  private:
    SurfaceActor surface_{renderer_};
    SurfaceActor walls_{renderer_};
    TrackActors track_{renderer_};
};

} // namespace

std::unique_ptr<Panel> make_top_panel() {
    return std::make_unique<TopPanel>();
}

} // namespace meltscope::viz
