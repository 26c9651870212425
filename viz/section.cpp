#include "viz/section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <vtkClipPolyData.h>
#include <vtkContourFilter.h>
#include <vtkDoubleArray.h>
#include <vtkImageDataGeometryFilter.h>
#include <vtkNew.h>
#include <vtkPointData.h>

namespace meltscope::viz {

namespace {

constexpr double most_cells = 40000.0;

} // namespace

vtkSmartPointer<vtkMatrix4x4> SectionPlane::matrix() const {
    auto matrix = vtkSmartPointer<vtkMatrix4x4>::New();
    const Vec3 normal = along.cross(Vec3::UnitZ());
    for (int row = 0; row < 3; ++row) {
        matrix->SetElement(row, 0, along[row]);
        matrix->SetElement(row, 1, row == 2 ? 1.0 : 0.0);
        matrix->SetElement(row, 2, normal[row]);
        matrix->SetElement(row, 3, row == 2 ? 0.0 : origin[row]);
    }
    return matrix;
}

SectionPlane track_plane(const Picture& picture) {
    const Geometry& geometry = *picture.instant->geometry;
    const BeamSnapshot* beam = leading_beam(*picture.instant->snapshot);
    SectionPlane plane;
    plane.along = track_direction(beam);
    if (beam != nullptr) {
        plane.origin = spot_center(*beam, geometry);
    } else {
        plane.origin = 0.5 * (geometry.lower + geometry.upper);
        plane.origin.z() = geometry.upper.z();
    }
    return plane;
}

std::array<double, 2> stretch_inside(const SectionPlane& plane, const NodeLattice& nodes) {
    std::array<double, 2> stretch{-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
    const Vec3 upper = upper_corner(nodes);
    for (int axis = 0; axis < 2; ++axis) {
        const double slope = plane.along[axis];
        if (std::abs(slope) > 1e-9) {
            const double a = (nodes.origin[axis] - plane.origin[axis]) / slope;
            const double b = (upper[axis] - plane.origin[axis]) / slope;
            stretch = {std::max(stretch[0], std::min(a, b)), std::min(stretch[1], std::max(a, b))};
        }
    }
    return stretch;
}

std::array<double, 2> stretch_around(const SectionPlane& plane, const NodeLattice& nodes, double width,
                                     double share) {
    const auto [low, high] = stretch_inside(plane, nodes);
    const double left =
        width >= high - low ? 0.5 * (low + high - width) : std::clamp(-share * width, low, high - width);
    return {left, left + width};
}

double ground(const SectionPlane& plane, const Geometry& geometry, double reach) {
    const double top = geometry.upper.z();
    return top - plane.origin.z() < reach ? top : plane.origin.z();
}

vtkSmartPointer<vtkPolyData> make_section(const Picture& picture, const SectionPlane& plane,
                                          const std::array<double, 4>& window) {
    const Snapshot& snapshot = *picture.instant->snapshot;
    const NodeLattice& nodes = snapshot.nodes;
    const auto inside = stretch_inside(plane, nodes);
    const double s_low = std::max(window[0], inside[0]);
    const double s_high = std::min(window[1], inside[1]);
    const double z_low = std::max(window[2], nodes.origin.z());
    const double z_high = std::min(window[3], upper_corner(nodes).z());
    auto section = vtkSmartPointer<vtkPolyData>::New();
    if (!(s_high > s_low) || !(z_high > z_low)) {
        return section;
    }
    const double wanted =
        std::max(0.5 * nodes.spacing, std::sqrt((s_high - s_low) * (z_high - z_low) / most_cells));
    const int s_count = std::max(2, static_cast<int>(std::ceil((s_high - s_low) / wanted)) + 1);
    const int z_count = std::max(2, static_cast<int>(std::ceil((z_high - z_low) / wanted)) + 1);
    vtkNew<vtkImageData> image;
    image->SetDimensions(s_count, z_count, 1);
    image->SetOrigin(s_low, z_low, 0.0);
    image->SetSpacing((s_high - s_low) / (s_count - 1), (z_high - z_low) / (z_count - 1), 1.0);

    const auto add = [&](const char* name, const std::vector<double>& field) {
        vtkNew<vtkDoubleArray> values;
        values->SetName(name);
        values->SetNumberOfTuples(image->GetNumberOfPoints());
        const FieldSampler sample(nodes, field);
        double position[3];
        for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i) {
            image->GetPoint(i, position);
            values->SetValue(i, sample(plane.point(position[0], position[1])));
        }
        image->GetPointData()->AddArray(values);
    };
    add("boundary", *snapshot.phi);
    add("temperature", *snapshot.temperature);
    if (picture.field != "temperature") {
        add(picture.field.c_str(), *picture.values);
    }
    vtkNew<vtkImageDataGeometryFilter> squares;
    squares->SetInputData(image);
    squares->Update();
    squares->GetOutput()->GetPointData()->SetActiveScalars("boundary");
    vtkNew<vtkClipPolyData> clip;
    clip->SetInputData(squares->GetOutput());
    clip->SetValue(0.0);
    clip->InsideOutOn();
    clip->Update();
    section->ShallowCopy(clip->GetOutput());
    section->GetPointData()->SetActiveScalars(picture.field.c_str());
    return section;
}

vtkSmartPointer<vtkPolyData> section_lines(vtkPolyData* section, const char* array,
                                           const std::vector<double>& values) {
    auto lines = vtkSmartPointer<vtkPolyData>::New();
    if (section->GetNumberOfCells() == 0) {
        return lines;
    }
    vtkNew<vtkPolyData> input;
    input->ShallowCopy(section);
    input->GetPointData()->SetActiveScalars(array);
    vtkNew<vtkContourFilter> contour;
    contour->SetInputData(input);
    for (std::size_t i = 0; i < values.size(); ++i) {
        contour->SetValue(static_cast<int>(i), values[i]);
    }
    contour->Update();
    lines->ShallowCopy(contour->GetOutput());
    return lines;
}

vtkSmartPointer<vtkPolyData> section_surface(vtkPolyData* section, const NodeLattice& nodes) {
    // The section ends where the distance is zero; just inside, every piece of the edge is found.
    return section_lines(section, "boundary", {-0.02 * nodes.spacing});
}

void PoolExtent::update(const Picture& picture) {
    const Snapshot& snapshot = *picture.instant->snapshot;
    const BeamSnapshot* beam = leading_beam(snapshot);
    const double spot = std::max(beam != nullptr ? beam->spot_radius : 0.0, 2.0 * snapshot.nodes.spacing);
    length = std::max(length, 4.0 * spot);
    width = std::max(width, 2.0 * spot);
    depth = std::max(depth, spot);
    const PoolFigures pool = shown_pool(snapshot);
    length = std::max(length, pool.length);
    width = std::max(width, pool.width);
    depth = std::max(depth, pool.depth);
}

} // namespace meltscope::viz
