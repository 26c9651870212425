#include "viz/actors.hpp"
#include "viz/annotations.hpp"
#include "viz/panel.hpp"
#include "viz/section.hpp"

#include <algorithm>
#include <cmath>

#include <vtkCellArray.h>
#include <vtkPointData.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

/// The beam in the plane: a band of light that fades upwards.
vtkSmartPointer<vtkPolyData> make_band(const BeamSnapshot& beam, const SectionPlane& plane, double height,
                                       const Rgb& color) {
    const Vec3 up = -beam.beam_direction;
    const double lean = up.dot(plane.along) / std::max(up.z(), 0.2);
    vtkNew<vtkPoints> points;
    vtkNew<vtkUnsignedCharArray> colors;
    vtkNew<vtkCellArray> quad;
    colors->SetNumberOfComponents(4);
    const double z = plane.origin.z();
    const double r = beam.spot_radius;
    // Behind the material, and from a little below the spot, so that no gap shows over an uneven surface.
    for (const auto& [s, rise] :
         {std::array{-r, -r}, std::array{r, -r}, std::array{1.5 * r, height}, std::array{-1.5 * r, height}}) {
        points->InsertNextPoint(s + lean * rise, z + rise, -0.1 * height);
        colors->InsertNextTuple4(255 * color[0], 255 * color[1], 255 * color[2], rise > 0.0 ? 0 : 150);
    }
    const vtkIdType corners[4] = {0, 1, 2, 3};
    quad->InsertNextCell(4, corners);
    auto band = vtkSmartPointer<vtkPolyData>::New();
    band->SetPoints(points);
    band->SetPolys(quad);
    band->GetPointData()->SetScalars(colors);
    return band;
}

/// The cut along the track through the laser, which always moves to the right.
class SectionPanel : public Panel {
  public:
    SectionPanel() {
        material_.actor()->GetProperty()->LightingOff();
        light_->SetMapper(light_mapper_);
        light_->GetProperty()->LightingOff();
        light_->ForceTranslucentOn();
        renderer_->AddActor(light_);
    }

    void update(const Picture& picture, const Rect& area, Canvas& canvas) override {
        const Rect scene = above_scale_bar(picture, area);
        place(picture, scene);
        const Snapshot& snapshot = *picture.instant->snapshot;
        const SectionPlane plane = track_plane(picture);
        extent_.update(picture);
        const auto window = choose_window(picture, plane, scene.width / scene.height);
        aim(window);

        const auto section = make_section(picture, plane, window);
        material_.update(section, picture);
        material_.actor()->SetVisibility(section->GetNumberOfCells() > 0);
        surface_.update(section_surface(section, snapshot.nodes), picture.theme->muted, 0.7 * picture.line);
        // As many isotherms as can be told apart.
        const int line_count = std::clamp(static_cast<int>(scene.height / (2.6 * picture.font)), 3, 8);
        std::vector<double> levels;
        for (const double level : nice_ticks(picture.range[0], picture.range[1], line_count)) {
            if (picture.field == "temperature" && level > picture.range[0] &&
                level < snapshot.solidus - 60.0) {
                levels.push_back(level);
            }
        }
        isotherms_.update(section_lines(section, "temperature", levels), picture.theme->solidus,
                          0.6 * picture.line);
        solidus_.update(section_lines(section, "temperature", {snapshot.solidus}), picture.theme->solidus,
                        picture.line);
        const auto liquidus = section_lines(section, "temperature", {snapshot.liquidus});
        liquidus_.update(liquidus, picture.theme->liquidus, 1.5 * picture.line);

        const BeamSnapshot* beam = leading_beam(snapshot);
        const bool shining = beam != nullptr && beam->on && beam->power > 0.0;
        light_->SetVisibility(shining);
        if (shining) {
            light_mapper_->SetInputData(
                make_band(*beam, plane, 0.9 * (window[3] - plane.origin.z()), picture.theme->beam));
        }

        const double pixels_per_metre = scene.height / (window[3] - window[2]);
        place_scale_bar(picture, area, {scene.x, area.y + 0.7 * picture.font}, pixels_per_metre, canvas);
        label_isotherms(picture, scene, section, levels, canvas);
    }

  private:
    /// s low, s high, z low, z high of what is shown.
    std::array<double, 4> choose_window(const Picture& picture, const SectionPlane& plane,
                                        double aspect) const {
        const Geometry& geometry = *picture.instant->geometry;
        const double thickness = geometry.upper.z() - geometry.lower.z();
        const auto [s_low, s_high] = stretch_inside(plane, geometry.nodes);
        const double wanted = std::max(5.0 * extent_.depth, 1.9 * extent_.length / aspect);
        // A third of the height is air; no more is shown than there is.
        double height = std::min({wanted, 1.35 * thickness});
        height = std::max(std::min(height, (s_high - s_low) / aspect), 8.0 * geometry.nodes.spacing);
        const auto [left, right] = stretch_around(plane, geometry.nodes, height * aspect, 0.66);
        const double top = ground(plane, geometry, 0.5 * height) + 0.25 * height;
        return {left, right, top - height, top};
    }

    void aim(const std::array<double, 4>& window) {
        const double s = 0.5 * (window[0] + window[1]);
        const double z = 0.5 * (window[2] + window[3]);
        const double height = window[3] - window[2];
        vtkCamera* camera = renderer_->GetActiveCamera();
        camera->ParallelProjectionOn();
        camera->SetParallelScale(0.5 * height);
        camera->SetFocalPoint(s, z, 0.0);
        camera->SetPosition(s, z, height);
        camera->SetViewUp(0.0, 1.0, 0.0);
        camera->SetClippingRange(0.1 * height, 2.0 * height);
    }

    /// A number at the lowest point of each line, where there is room.
    void label_isotherms(const Picture& picture, const Rect& scene, vtkPolyData* section,
                         const std::vector<double>& levels, Canvas& canvas) {
        const Snapshot& snapshot = *picture.instant->snapshot;
        std::vector<std::pair<double, std::string>> wanted{{snapshot.liquidus, "liquidus"}};
        for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
            wanted.emplace_back(*level, fmt::format("{:.0f} K", *level));
        }
        TextStyle style;
        style.size = 0.8 * picture.font;
        style.color = picture.theme->liquidus;
        style.horizontal = Align::middle;
        style.vertical = Align::high;
        std::vector<Rect> taken;
        for (const auto& [level, words] : wanted) {
            const auto line = section_lines(section, "temperature", {level});
            double lowest[3] = {0.0, 1e30, 0.0};
            for (vtkIdType i = 0; i < line->GetNumberOfPoints(); ++i) {
                double point[3];
                line->GetPoint(i, point);
                const double across = to_pixel(picture, scene, Vec3(point[0], point[1], 0.0))[0] - scene.x;
                if (point[1] < lowest[1] && across > 0.07 * scene.width && across < 0.93 * scene.width) {
                    std::copy(point, point + 3, lowest);
                }
            }
            if (lowest[1] > 1e29) {
                continue;
            }
            const Pixel at = to_pixel(picture, scene, Vec3(lowest[0], lowest[1], 0.0));
            const auto [width, height] = Canvas::extent(words, style);
            const Rect box{at[0] - 0.5 * width - 3.0, at[1] - 0.25 * picture.font - height - 2.0, width + 6.0,
                           height + 4.0};
            const bool fits = box.x > scene.x && box.x + box.width < scene.x + scene.width && box.y > scene.y;
            const bool free = std::none_of(taken.begin(), taken.end(), [&](const Rect& other) {
                return box.x < other.x + other.width && box.x + box.width > other.x &&
                       box.y < other.y + other.height && box.y + box.height > other.y;
            });
            if (fits && free) {
                canvas.fill(box, {0.0, 0.0, 0.0}, 0.35);
                canvas.text({at[0], at[1] - 0.25 * picture.font}, words, style);
                taken.push_back(box);
            }
        }
    }

    PoolExtent extent_;
    SurfaceActor material_{renderer_};
    LineActor surface_{renderer_};
    LineActor isotherms_{renderer_};
    LineActor solidus_{renderer_};
    LineActor liquidus_{renderer_};
    vtkNew<vtkActor> light_;
    vtkNew<vtkPolyDataMapper> light_mapper_;
};

} // namespace

std::unique_ptr<Panel> make_section_panel() {
    return std::make_unique<SectionPanel>();
}

} // namespace meltscope::viz
