#include "viz/actors.hpp"
#include "viz/annotations.hpp"
#include "viz/panel.hpp"

namespace meltscope::viz {

namespace {

/// The whole part from above and aside, with its cut faces, so that a plate looks like the block it is.
class OverviewPanel : public Panel {
  public:
    void update(const Picture& picture, const Rect& area, Canvas& canvas) override {
        place(picture, area);
        const Geometry& geometry = *picture.instant->geometry;
        surface_.update(picture.surface, picture);
        walls_.update(picture.walls, picture);
        // A little outside, so that the part does not hide half of each line.
        const Vec3 gap = Vec3::Constant(0.0008 * (geometry.upper - geometry.lower).norm());
        edges_.update(make_box_edges(geometry.lower - gap, geometry.upper + gap), picture.theme->muted,
                      0.5 * picture.line);

        // The longer side faces the viewer.
        const Vec3 size = geometry.upper - geometry.lower;
        const double beam_height = 0.11 * size.norm();
        track_.update(picture, size.norm(), beam_height);
        const bool along_x = size.x() >= size.y();
        const Vec3 along = along_x ? Vec3::UnitX() : Vec3::UnitY();
        const Vec3 front = along_x ? Vec3(-Vec3::UnitY()) : Vec3::UnitX();
        const double long_side = along_x ? size.x() : size.y();

        // A scale bar lies on the ground before the part.
        const double bar = round_down(0.22 * long_side);
        const double away = 0.06 * long_side;
        Vec3 start = geometry.lower;
        if (!along_x) {
            start.x() = geometry.upper.x();
        }
        start += away * front;
        const Vec3 end = start + bar * along;
        const Vec3 tick = 0.012 * long_side * front;
        scale_.update(make_lines({{start, end}, {start - tick, start + tick}, {end - tick, end + tick}}),
                      picture.theme->text, picture.line);

        std::vector<Vec3> points{start + 2.5 * tick, end + 2.5 * tick};
        for (int corner = 0; corner < 8; ++corner) {
            points.emplace_back((corner & 1) != 0 ? geometry.upper.x() : geometry.lower.x(),
                                (corner & 2) != 0 ? geometry.upper.y() : geometry.lower.y(),
                                // Room for the beams, but for their faintest part.
                                (corner & 4) != 0 ? geometry.upper.z() + 0.6 * beam_height
                                                  : geometry.lower.z());
        }
        fit_camera(renderer_->GetActiveCamera(), points, -(front - 0.32 * along + 0.85 * Vec3::UnitZ()),
                   Vec3::UnitZ(), area.width / area.height);
        renderer_->ResetCameraClippingRange();

        TextStyle style;
        style.size = picture.font;
        style.color = picture.theme->text;
        style.horizontal = Align::middle;
        style.vertical = Align::high;
        Pixel label = to_pixel(picture, area, 0.5 * (start + end) + tick);
        label[1] -= 0.6 * picture.font;
        canvas.text(label, format_length(bar), style);
    }

  private:
    SurfaceActor surface_{renderer_};
    SurfaceActor walls_{renderer_};
    LineActor edges_{renderer_};
    LineActor scale_{renderer_};
    TrackActors track_{renderer_};
};

} // namespace

std::unique_ptr<Panel> make_overview_panel() {
    return std::make_unique<OverviewPanel>();
}

} // namespace meltscope::viz
