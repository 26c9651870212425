#include "viz/actors.hpp"
#include "viz/annotations.hpp"
#include "viz/panel.hpp"
#include "viz/section.hpp"

#include <algorithm>
#include <cmath>

#include <vtkClipPolyData.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPointData.h>
#include <vtkProperty.h>

namespace meltscope::viz {

namespace {

/// A close-up that follows the laser: the part is cut open along the track, and the near half of the pool
/// stands out.
class PoolPanel : public Panel {
  public:
    PoolPanel() {
        section_.actor()->GetProperty()->LightingOff();
        // The bowl looks down, away from the light above.
        isotherm_.actor()->GetProperty()->SetAmbient(0.85);
        for (SurfaceActor* part : {&surface_, &walls_}) {
            part->mapper()->AddClippingPlane(far_half_);
        }
        for (SurfaceActor* part : {&isotherm_, &cap_}) {
            part->mapper()->AddClippingPlane(near_half_);
        }
        track_.clip_paths(path_half_);
    }

    void update(const Picture& picture, const Rect& area, Canvas& canvas) override {
        const double strip = 2.2 * picture.font;
        const Rect scene{area.x, area.y + strip, area.width, area.height - strip};
        place(picture, scene);
        extent_.update(picture);
        const Snapshot& snapshot = *picture.instant->snapshot;
        const Geometry& geometry = *picture.instant->geometry;
        SectionPlane plane = track_plane(picture);
        // The viewer stands where the scan goes to the right.
        const Vec3 away = plane.across();
        for (const auto& [cut, side] : {std::pair{far_half_.Get(), 1.0}, std::pair{near_half_.Get(), -1.0}}) {
            // The far half reaches a little over the cut, so that no crack shows along its edge.
            const Vec3 origin = plane.origin - (side > 0.0 ? 0.05 * geometry.nodes.spacing : 0.0) * away;
            const Vec3 normal = side * away;
            cut->SetOrigin(origin.data());
            cut->SetNormal(normal.data());
        }
        // Nothing lies below the paths of the half that is cut away, but the track itself is to be seen.
        const Vec3 beside_track = plane.origin - 1.5 * geometry.nodes.spacing * away;
        path_half_->SetOrigin(beside_track.data());
        path_half_->SetNormal(away.data());
        surface_.update(picture.surface, picture);
        walls_.update(picture.walls, picture);
        isotherm_.update(picture.instant->pool.isotherm, picture);
        cap_.update(picture.instant->pool.cap, picture);
        for (SurfaceActor* part : {&isotherm_, &cap_}) {
            part->actor()->SetVisibility(picture.field == "temperature" &&
                                         picture.instant->pool.isotherm->GetNumberOfCells() > 0);
        }

        const double top = ground(plane, geometry, 2.0 * extent_.depth);
        const double bottom = std::max(top - 1.5 * extent_.depth, geometry.lower.z());
        const std::array<double, 4> stretch{-4.0 * extent_.length, 3.0 * extent_.length, geometry.lower.z(),
                                            geometry.upper.z()};
        const auto section = make_section(picture, plane, stretch);
        section_.update(section, picture);
        section_.actor()->SetVisibility(section->GetNumberOfCells() > 0);
        section_.actor()->SetUserMatrix(plane.matrix());
        solidus_.update(section_lines(section, "temperature", {snapshot.solidus}), picture.theme->solidus,
                        picture.line);
        solidus_.actor()->SetUserMatrix(plane.matrix());
        edge_.update(colder_than(section_surface(section, snapshot.nodes), snapshot.liquidus),
                     picture.theme->muted, 0.7 * picture.line);
        edge_.actor()->SetUserMatrix(before_the_cut(plane, geometry.nodes.spacing));
        track_.update(picture, 1.6 * extent_.length, 0.22 * extent_.length);

        // A pool that is drawn out lies behind its laser.
        const auto [low, high] = stretch_inside(plane, geometry.nodes);
        const auto stretch_shown =
            stretch_around(plane, geometry.nodes, std::min(1.35 * extent_.length, high - low),
                           has_moved(leading_beam(snapshot)) ? 0.8 : 0.5);
        std::vector<Vec3> corners;
        for (const double s : stretch_shown) {
            for (const double z : {bottom, top + 0.5 * extent_.depth}) {
                corners.push_back(plane.point(s, z) + 0.55 * extent_.width * away);
            }
            for (const double z : {top - extent_.depth, top}) {
                corners.push_back(plane.point(s, z) - 0.5 * extent_.width * away);
            }
            corners.push_back(plane.point(s, bottom));
        }
        fit_camera(renderer_->GetActiveCamera(), corners, away + 0.22 * plane.along - 0.5 * Vec3::UnitZ(),
                   Vec3::UnitZ(), scene.width / scene.height);
        renderer_->ResetCameraClippingRange();

        const double unit = 0.1 * extent_.length;
        const Pixel from = to_pixel(picture, scene, plane.origin);
        const Pixel to = to_pixel(picture, scene, plane.origin + unit * plane.along);
        draw_scale_bar(canvas, picture, {scene.x, area.y + 0.7 * picture.font},
                       std::hypot(to[0] - from[0], to[1] - from[1]) / unit, 0.25 * scene.width);
    }

  private:
    static bool has_moved(const BeamSnapshot* beam) {
        return beam != nullptr && (beam->scan_direction.norm() > 0.0 || beam->path_done.size() > 1);
    }

    /// The edge of the cut without its stretches through the pool, which stands out before them.
    static vtkSmartPointer<vtkPolyData> colder_than(vtkPolyData* edge, double temperature) {
        if (edge->GetNumberOfCells() == 0) {
            return edge;
        }
        edge->GetPointData()->SetActiveScalars("temperature");
        vtkNew<vtkClipPolyData> clip;
        clip->SetInputData(edge);
        clip->SetValue(temperature);
        clip->InsideOutOn();
        clip->Update();
        return clip->GetOutput();
    }

    /// As the plane's own, but a little nearer and lower, where the line of the cut's edge is not half hidden
    /// by the surface it bounds and stays below the pool that stands out.
    static vtkSmartPointer<vtkMatrix4x4> before_the_cut(const SectionPlane& plane, double spacing) {
        SectionPlane nearer = plane;
        nearer.origin -= 0.12 * spacing * plane.across();
        auto matrix = nearer.matrix();
        matrix->SetElement(2, 3, -0.1 * spacing);
        return matrix;
    }

    PoolExtent extent_;
    vtkNew<vtkPlane> far_half_;
    vtkNew<vtkPlane> near_half_;
    vtkNew<vtkPlane> path_half_;
    SurfaceActor surface_{renderer_};
    SurfaceActor walls_{renderer_};
    SurfaceActor section_{renderer_};
    SurfaceActor isotherm_{renderer_};
    SurfaceActor cap_{renderer_};
    LineActor solidus_{renderer_};
    LineActor edge_{renderer_};
    TrackActors track_{renderer_};
};

} // namespace

std::unique_ptr<Panel> make_pool_panel() {
    return std::make_unique<PoolPanel>();
}

} // namespace meltscope::viz
