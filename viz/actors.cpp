#include "viz/actors.hpp"

#include "meltscope/constants.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <vtkCellArray.h>
#include <vtkPointData.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

namespace meltscope::viz {

namespace {

constexpr std::size_t most_path_points = 20000;
constexpr double dim = 0.45; // opacity of moves without light

double length_of(const std::vector<PathCorner>& corners) {
    double sum = 0.0;
    for (std::size_t i = 1; i < corners.size(); ++i) {
        sum += (corners[i].position - corners[i - 1].position).norm();
    }
    return sum;
}

/// Lays points on the free surface below or above them, a little above it. Over powder, where a line would
/// jump from ball to ball, at the height of the highest of the points that it is made for.
class Drape {
  public:
    Drape(const Geometry& geometry, const Vec3& beam_direction,
          const std::vector<std::vector<PathCorner>>& lines)
        : geometry_(geometry), vertical_(std::abs(beam_direction.z()) > 0.9) {
        if (vertical_) {
            level_rough_ground(lines);
        }
    }

    /// False beside the domain, where a path may run but nothing is to be seen.
    bool covers(const Vec3& point) const {
        const Vec3 upper = upper_corner(geometry_.nodes);
        return (point.head<2>().array() >= geometry_.nodes.origin.head<2>().array()).all() &&
               (point.head<2>().array() <= upper.head<2>().array()).all();
    }

    Vec3 operator()(const Vec3& point) const {
        Vec3 laid = point;
        if (level_) {
            laid.z() = *level_;
        } else if (vertical_) {
            if (const auto height = geometry_.heights.at(point.x(), point.y())) {
                laid.z() = *height;
            }
        }
        laid.z() += 0.15 * geometry_.nodes.spacing;
        return laid;
    }

  private:
    void level_rough_ground(const std::vector<std::vector<PathCorner>>& lines) {
        constexpr double rough = 3.0; // cells
        constexpr std::size_t most_looks = 4000;
        double low = std::numeric_limits<double>::max();
        double high = std::numeric_limits<double>::lowest();
        for (const std::vector<PathCorner>& line : lines) {
            const double step = std::max(geometry_.nodes.spacing, length_of(line) / most_looks);
            for (std::size_t i = 1; i < line.size(); ++i) {
                const Vec3& from = line[i - 1].position;
                const Vec3 along = line[i].position - from;
                const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm() / step)));
                for (int piece = 0; piece <= pieces; ++piece) {
                    const Vec3 point = from + along * piece / pieces;
                    const auto height =
                        covers(point) ? geometry_.heights.at(point.x(), point.y()) : std::nullopt;
                    if (height) {
                        low = std::min(low, *height);
                        high = std::max(high, *height);
                    }
                }
            }
        }
        if (high - low > rough * geometry_.nodes.spacing) {
            level_ = high;
        }
    }

    const Geometry& geometry_;
    bool vertical_;
    std::optional<double> level_; ///< m
};

/// What of the path is run with light, or without, on the surface; with `dash` > 0 every other piece of that
/// length (m), counted from the path's end so that dashes stand still while the beam eats the path up.
std::vector<std::vector<Vec3>> drape_path(const std::vector<PathCorner>& corners, bool lit,
                                          const Drape& drape, double step, double dash) {
    std::vector<std::vector<Vec3>> lines;
    if (corners.size() < 2) {
        return lines;
    }
    const double total = length_of(corners);
    step = std::max(step, total / static_cast<double>(most_path_points));
    double left = total;
    bool pen_down = false;
    for (std::size_t i = 1; i < corners.size(); ++i) {
        const Vec3& begin = corners[i - 1].position;
        const Vec3 along = corners[i].position - begin;
        const double length = along.norm();
        pen_down = pen_down && corners[i].lit == lit;
        const int pieces =
            corners[i].lit == lit ? std::max(1, static_cast<int>(std::ceil(length / step))) : 0;
        for (int piece = 0; piece < pieces; ++piece) {
            const double from = static_cast<double>(piece) / pieces;
            const double to = static_cast<double>(piece + 1) / pieces;
            const double middle = left - length * 0.5 * (from + to);
            const bool gap = dash > 0.0 && std::fmod(middle, 2.0 * dash) > dash;
            if (gap || !drape.covers(begin + 0.5 * (from + to) * along)) {
                pen_down = false;
                continue;
            }
            if (!pen_down) {
                lines.push_back({drape(begin + from * along)});
                pen_down = true;
            }
            lines.back().push_back(drape(begin + to * along));
        }
        left -= length;
    }
    return lines;
}

std::pair<Vec3, Vec3> across(const Vec3& direction) {
    const Vec3 first =
        direction.cross(std::abs(direction.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
    return {first, direction.cross(first)};
}

std::vector<Vec3> circle(const BeamSnapshot& beam, const Geometry& geometry) {
    constexpr int corners = 72;
    const auto [u, v] = across(beam.beam_direction);
    const Vec3 center = spot_center(beam, geometry);
    std::vector<PathCorner> ring;
    for (int i = 0; i <= corners; ++i) {
        const double angle = 2.0 * constants::pi * i / corners;
        ring.push_back({center + beam.spot_radius * (std::cos(angle) * u + std::sin(angle) * v)});
    }
    const Drape drape(geometry, beam.beam_direction, {ring});
    std::vector<Vec3> laid;
    for (const PathCorner& corner : ring) {
        laid.push_back(drape(corner.position));
    }
    return laid;
}

/// Columns of light that fade upwards, one a beam that is on.
vtkSmartPointer<vtkPolyData> make_light(const Picture& picture, double height) {
    constexpr int sides = 36;
    const Geometry& geometry = *picture.instant->geometry;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> quads;
    vtkNew<vtkUnsignedCharArray> colors;
    colors->SetNumberOfComponents(4);
    const Rgb& rgb = picture.theme->beam;
    for (const BeamSnapshot& beam : picture.instant->snapshot->beams) {
        if (!beam.on || beam.power <= 0.0) {
            continue;
        }
        const auto [u, v] = across(beam.beam_direction);
        const Vec3 center = spot_center(beam, geometry);
        const vtkIdType first = points->GetNumberOfPoints();
        for (int i = 0; i < sides; ++i) {
            const double angle = 2.0 * constants::pi * i / sides;
            const Vec3 offset = beam.spot_radius * (std::cos(angle) * u + std::sin(angle) * v);
            for (const double along : {0.0, height}) {
                const Vec3 point = center + offset * (along > 0.0 ? 1.6 : 1.0) - along * beam.beam_direction;
                points->InsertNextPoint(point.data());
                colors->InsertNextTuple4(255 * rgb[0], 255 * rgb[1], 255 * rgb[2], along > 0.0 ? 0 : 110);
            }
            const vtkIdType a = first + 2 * i;
            const vtkIdType b = first + 2 * ((i + 1) % sides);
            const vtkIdType quad[4] = {a, b, b + 1, a + 1};
            quads->InsertNextCell(4, quad);
        }
    }
    auto light = vtkSmartPointer<vtkPolyData>::New();
    light->SetPoints(points);
    light->SetPolys(quads);
    light->GetPointData()->SetScalars(colors);
    return light;
}

} // namespace

SurfaceActor::SurfaceActor(vtkRenderer* renderer) {
    mapper_->SetInterpolateScalarsBeforeMapping(true);
    mapper_->SetScalarModeToUsePointData();
    mapper_->SetUseLookupTableScalarRange(true);
    mapper_->SetResolveCoincidentTopologyToPolygonOffset();
    actor_->SetMapper(mapper_);
    // A face turned up shows the field's own colour, others a darker one.
    actor_->GetProperty()->SetAmbient(0.55);
    actor_->GetProperty()->SetDiffuse(0.45);
    renderer->AddActor(actor_);
}

void SurfaceActor::update(vtkPolyData* surface, const Picture& picture) {
    mapper_->SetInputData(surface);
    mapper_->SetLookupTable(picture.colors);
}

LineActor::LineActor(vtkRenderer* renderer) {
    mapper_->ScalarVisibilityOff();
    mapper_->SetResolveCoincidentTopologyToPolygonOffset();
    mapper_->SetRelativeCoincidentTopologyLineOffsetParameters(-2.0, -8.0);
    actor_->SetMapper(mapper_);
    actor_->GetProperty()->LightingOff();
    renderer->AddActor(actor_);
}

void LineActor::update(vtkPolyData* lines, const Rgb& color, double width, double opacity) {
    mapper_->SetInputData(lines);
    actor_->GetProperty()->SetColor(color[0], color[1], color[2]);
    actor_->GetProperty()->SetLineWidth(static_cast<float>(width));
    actor_->GetProperty()->SetOpacity(opacity);
    actor_->SetVisibility(lines->GetNumberOfCells() > 0);
}

vtkSmartPointer<vtkPolyData> make_lines(const std::vector<std::vector<Vec3>>& lines) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    for (const std::vector<Vec3>& line : lines) {
        cells->InsertNextCell(static_cast<int>(line.size()));
        for (const Vec3& point : line) {
            cells->InsertCellPoint(points->InsertNextPoint(point.data()));
        }
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetLines(cells);
    return data;
}

vtkSmartPointer<vtkPolyData> make_box_edges(const Vec3& lower, const Vec3& upper) {
    std::vector<std::vector<Vec3>> edges;
    for (int axis = 0; axis < 3; ++axis) {
        for (int corner = 0; corner < 4; ++corner) {
            Vec3 from = lower;
            const int u = (axis + 1) % 3;
            const int v = (axis + 2) % 3;
            from[u] = (corner & 1) != 0 ? upper[u] : lower[u];
            from[v] = (corner & 2) != 0 ? upper[v] : lower[v];
            Vec3 to = from;
            to[axis] = upper[axis];
            edges.push_back({from, to});
        }
    }
    return make_lines(edges);
}

TrackActors::TrackActors(vtkRenderer* renderer)
    : moves_to_come_(renderer), moves_done_(renderer), path_to_come_(renderer), path_done_(renderer),
      liquidus_(renderer), spots_(renderer) {
    light_->SetMapper(light_mapper_);
    light_->GetProperty()->LightingOff();
    light_->ForceTranslucentOn();
    light_->SetVisibility(false);
    renderer->AddActor(light_);
}

void TrackActors::clip_paths(vtkPlane* plane) {
    for (LineActor* path : {&path_to_come_, &path_done_, &moves_to_come_, &moves_done_}) {
        path->mapper()->AddClippingPlane(plane);
    }
}

void TrackActors::update(const Picture& picture, double view_size, double beam_height) {
    const Snapshot& snapshot = *picture.instant->snapshot;
    const Geometry& geometry = *picture.instant->geometry;
    const Theme& colors = *picture.theme;
    const double step = 2.0 * geometry.nodes.spacing;
    const double dash = 0.008 * view_size;
    std::array<std::vector<std::vector<Vec3>>, 2> done; // without light, with light
    std::array<std::vector<std::vector<Vec3>>, 2> to_come;
    std::vector<std::vector<Vec3>> rings;
    for (const BeamSnapshot& beam : snapshot.beams) {
        const Drape drape(geometry, beam.beam_direction, {beam.path_done, beam.path_to_come});
        for (const bool lit : {false, true}) {
            std::ranges::move(drape_path(beam.path_done, lit, drape, step, 0.0),
                              std::back_inserter(done[lit]));
            std::ranges::move(drape_path(beam.path_to_come, lit, drape, std::min(step, 0.5 * dash), dash),
                              std::back_inserter(to_come[lit]));
        }
        if (beam.on && beam.power > 0.0) {
            rings.push_back(circle(beam, geometry));
        }
    }
    moves_done_.update(make_lines(done[0]), colors.path_done, 0.5 * picture.line, dim);
    moves_to_come_.update(make_lines(to_come[0]), colors.path_to_come, 0.5 * picture.line, dim);
    path_done_.update(make_lines(done[1]), colors.path_done, 1.1 * picture.line);
    path_to_come_.update(make_lines(to_come[1]), colors.path_to_come, 0.9 * picture.line);
    liquidus_.update(picture.instant->pool.line, colors.liquidus, 1.3 * picture.line);
    spots_.update(make_lines(rings), colors.beam, 1.3 * picture.line);
    const auto light = make_light(picture, beam_height);
    light_mapper_->SetInputData(light);
    light_->SetVisibility(beam_height > 0.0 && light->GetNumberOfCells() > 0);
}

} // namespace meltscope::viz
