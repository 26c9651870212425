#include "viz/actors.hpp"
#include "viz/annotations.hpp"
#include "viz/panel.hpp"
#include "viz/section.hpp"

#include <algorithm>

#include <vtkPlane.h>
#include <vtkProperty.h>

namespace meltscope::viz {

namespace {

/// A close-up that follows the laser: the part is cut open along the track, and the near half of the pool
/// stands out.
class PoolPanel : public Panel {
  public:
    PoolPanel() {
        section_.actor()->GetProperty()->LightingOff();
        for (SurfaceActor* part : {&surface_, &walls_}) {
            part->mapper()->AddClippingPlane(far_half_);
        }
        for (SurfaceActor* part : {&isotherm_, &cap_}) {
            part->mapper()->AddClippingPlane(near_half_);
        }
    }

    void update(const Picture& picture, const Rect& area, Canvas& canvas) override {
        place(picture, area);
        extent_.update(picture);
        const Snapshot& snapshot = *picture.instant->snapshot;
        const Geometry& geometry = *picture.instant->geometry;
        SectionPlane plane = track_plane(picture);
        // The viewer stands where the scan goes to the right.
        const Vec3 away = plane.across();
        for (const auto& [cut, side] : {std::pair{far_half_.Get(), 1.0}, std::pair{near_half_.Get(), -1.0}}) {
            cut->SetOrigin(plane.origin.data());
            const Vec3 normal = side * away;
            cut->SetNormal(normal.data());
        }
        surface_.update(picture.surface, picture);
        walls_.update(picture.walls, picture);
        isotherm_.update(picture.instant->pool.isotherm, picture);
        cap_.update(picture.instant->pool.cap, picture);
        for (SurfaceActor* part : {&isotherm_, &cap_}) {
            part->actor()->SetVisibility(picture.field == "temperature" &&
                                         picture.instant->pool.isotherm->GetNumberOfCells() > 0);
        }

        const double bottom = std::max(plane.origin.z() - 2.1 * extent_.depth, geometry.lower.z());
        const std::array<double, 4> stretch{-4.0 * extent_.length, 3.0 * extent_.length, geometry.lower.z(),
                                            geometry.upper.z()};
        const auto section = make_section(picture, plane, stretch);
        section_.update(section, picture);
        section_.actor()->SetVisibility(section->GetNumberOfCells() > 0);
        section_.actor()->SetUserMatrix(plane.matrix());
        solidus_.update(section_isotherms(section, {snapshot.solidus}), picture.theme->solidus, picture.line);
        solidus_.actor()->SetUserMatrix(plane.matrix());
        track_.update(picture);

        std::vector<Vec3> corners;
        for (const double s : {-1.12 * extent_.length, 0.3 * extent_.length}) {
            for (const double side : {-0.5 * extent_.width, 0.55 * extent_.width}) {
                for (const double z : {bottom, plane.origin.z() + 0.1 * extent_.depth}) {
                    corners.push_back(plane.point(s, z) + side * away);
                }
            }
        }
        fit_camera(renderer_->GetActiveCamera(), corners, away + 0.22 * plane.along - 0.5 * Vec3::UnitZ(),
                   Vec3::UnitZ(), area.width / area.height);
        renderer_->ResetCameraClippingRange();

        // Drawn along the cut's lower edge in sight.
        const double bar = round_down(0.3 * extent_.length);
        const Pixel from = to_pixel(picture, area, plane.point(0.0, plane.origin.z()));
        const Pixel to = to_pixel(picture, area, plane.point(bar, plane.origin.z()));
        const double pixels_per_metre = std::hypot(to[0] - from[0], to[1] - from[1]) / bar;
        (void)canvas;
        (void)pixels_per_metre;
    }

  private:
    PoolExtent extent_;
    vtkNew<vtkPlane> far_half_;
    vtkNew<vtkPlane> near_half_;
    SurfaceActor surface_{renderer_};
    SurfaceActor walls_{renderer_};
    SurfaceActor section_{renderer_};
    SurfaceActor isotherm_{renderer_};
    SurfaceActor cap_{renderer_};
    LineActor solidus_{renderer_};
    TrackActors track_{renderer_, true};
};

} // namespace

std::unique_ptr<Panel> make_pool_panel() {
    return std::make_unique<PoolPanel>();
}

} // namespace meltscope::viz
