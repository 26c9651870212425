#include "viz/data_sets.hpp"

#include "viz/options.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include <vtkAppendPolyData.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkClipPolyData.h>
#include <vtkContourFilter.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkReverseSense.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

constexpr const char* temperature_name = "temperature";

vtkSmartPointer<vtkPolyData> empty_data_set() {
    auto empty = vtkSmartPointer<vtkPolyData>::New();
    empty->SetPoints(vtkNew<vtkPoints>());
    return empty;
}

/// The isosurface of one field, carrying another; normals point to where the field falls (rises if
/// `towards_higher`).
vtkSmartPointer<vtkPolyData> isosurface(const NodeLattice& nodes, const std::vector<double>& field,
                                        double value, bool towards_higher, const std::vector<double>* carried,
                                        const char* carried_name) {
    const auto image = make_image(nodes);
    image->GetPointData()->SetScalars(wrap(field, "contoured"));
    if (carried != nullptr) {
        image->GetPointData()->AddArray(wrap(*carried, carried_name));
    }
    vtkNew<vtkFlyingEdges3D> contour;
    contour->SetInputData(image);
    contour->SetValue(0, value);
    contour->ComputeNormalsOn();
    contour->ComputeScalarsOff();
    contour->SetInterpolateAttributes(carried != nullptr);
    // Triangles must turn the way their normals point: renderers tell a face's outer side by it.
    vtkNew<vtkReverseSense> reverse;
    reverse->SetInputConnection(contour->GetOutputPort());
    reverse->SetReverseCells(towards_higher);
    reverse->SetReverseNormals(towards_higher);
    reverse->Update();
    auto surface = vtkSmartPointer<vtkPolyData>::New();
    surface->ShallowCopy(reverse->GetOutput());
    surface->GetPointData()->RemoveArray("contoured");
    if (vtkDataArray* normals = surface->GetPointData()->GetNormals()) {
        normals->SetName("normals");
    }
    if (surface->GetPoints() == nullptr) {
        surface = empty_data_set();
    }
    return surface;
}

/// Keeps where the point array is below (or above) the value.
vtkSmartPointer<vtkPolyData> clip(vtkPolyData* surface, const char* array, double value, bool keep_below) {
    if (surface->GetNumberOfCells() == 0) {
        return empty_data_set();
    }
    surface->GetPointData()->SetActiveScalars(array);
    vtkNew<vtkClipPolyData> clipper;
    clipper->SetInputData(surface);
    clipper->SetValue(value);
    clipper->SetInsideOut(keep_below);
    clipper->Update();
    auto part = vtkSmartPointer<vtkPolyData>::New();
    part->ShallowCopy(clipper->GetOutput());
    return part;
}

/// One face of the domain as polygons where phi < 0, clipped by linear interpolation along the edges of its
/// squares.
class WallBuilder {
  public:
    WallBuilder(const NodeLattice& nodes, const std::vector<double>& phi) : nodes_(nodes), phi_(phi) {}

    void add_face(std::size_t axis, bool upper) {
        const std::size_t u = (axis + 1) % 3;
        const std::size_t v = (axis + 2) % 3;
        const std::int64_t fixed = upper ? nodes_.count[axis] - 1 : 0;
        const auto node_at = [&](std::int64_t a, std::int64_t b) {
            std::array<std::int64_t, 3> node{};
            node[axis] = fixed;
            node[u] = a;
            node[v] = b;
            return node;
        };
        normal_ = {0.0F, 0.0F, 0.0F};
        normal_[axis] = upper ? 1.0F : -1.0F;
        point_of_node_.assign(static_cast<std::size_t>(nodes_.count[u] * nodes_.count[v]), -1);
        for (std::int64_t b = 0; b + 1 < nodes_.count[v]; ++b) {
            for (std::int64_t a = 0; a + 1 < nodes_.count[u]; ++a) {
                std::array<Corner, 4> corners{
                    corner(node_at(a, b), a + nodes_.count[u] * b),
                    corner(node_at(a + 1, b), a + 1 + nodes_.count[u] * b),
                    corner(node_at(a + 1, b + 1), a + 1 + nodes_.count[u] * (b + 1)),
                    corner(node_at(a, b + 1), a + nodes_.count[u] * (b + 1))};
                if (!upper) {
                    std::reverse(corners.begin(), corners.end());
                }
                add_square(corners);
            }
        }
    }

    vtkSmartPointer<vtkPolyData> take() {
        auto walls = vtkSmartPointer<vtkPolyData>::New();
        walls->SetPoints(points_);
        walls->SetPolys(polygons_);
        normals_->SetName("normals");
        walls->GetPointData()->SetNormals(normals_);
        return walls;
    }

  private:
    struct Corner {
        Vec3 position;
        double phi = 0.0;
        std::size_t slot = 0; ///< of the node on its face
    };

    Corner corner(const std::array<std::int64_t, 3>& node, std::int64_t slot) const {
        const std::int64_t index = node[0] + nodes_.count[0] * (node[1] + nodes_.count[1] * node[2]);
        const Vec3 steps(static_cast<double>(node[0]), static_cast<double>(node[1]),
                         static_cast<double>(node[2]));
        return {nodes_.origin + nodes_.spacing * steps, phi_[static_cast<std::size_t>(index)],
                static_cast<std::size_t>(slot)};
    }

    vtkIdType insert(const Vec3& position) {
        normals_->InsertNextTuple(normal_.data());
        return points_->InsertNextPoint(position.data());
    }

    void add_square(const std::array<Corner, 4>& corners) {
        std::array<vtkIdType, 8> polygon{};
        vtkIdType count = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const Corner& here = corners[i];
            const Corner& next = corners[(i + 1) % 4];
            if (here.phi <= 0.0) {
                vtkIdType& point = point_of_node_[here.slot];
                point = point < 0 ? insert(here.position) : point;
                polygon[static_cast<std::size_t>(count++)] = point;
            }
            if ((here.phi < 0.0 && next.phi > 0.0) || (here.phi > 0.0 && next.phi < 0.0)) {
                const double fraction = here.phi / (here.phi - next.phi);
                polygon[static_cast<std::size_t>(count++)] =
                    insert(here.position + fraction * (next.position - here.position));
            }
        }
        if (count >= 3) {
            polygons_->InsertNextCell(count, polygon.data());
        }
    }

    const NodeLattice& nodes_;
    const std::vector<double>& phi_;
    std::array<float, 3> normal_{};
    std::vector<vtkIdType> point_of_node_;
    vtkNew<vtkPoints> points_;
    vtkNew<vtkCellArray> polygons_;
    vtkSmartPointer<vtkFloatArray> normals_ = [] {
        auto normals = vtkSmartPointer<vtkFloatArray>::New();
        normals->SetNumberOfComponents(3);
        return normals;
    }();
};

void find_material_box(Geometry& geometry) {
    geometry.lower.setConstant(std::numeric_limits<double>::max());
    geometry.upper.setConstant(std::numeric_limits<double>::lowest());
    bool any = false;
    for (vtkPolyData* part : {geometry.free_surface.Get(), geometry.walls.Get()}) {
        if (part->GetNumberOfCells() == 0) {
            continue;
        }
        any = true;
        double bounds[6];
        part->GetBounds(bounds);
        geometry.lower = geometry.lower.cwiseMin(Vec3(bounds[0], bounds[2], bounds[4]));
        geometry.upper = geometry.upper.cwiseMax(Vec3(bounds[1], bounds[3], bounds[5]));
    }
    if (!any) {
        geometry.lower = geometry.nodes.origin;
        geometry.upper = upper_corner(geometry.nodes);
    }
}

} // namespace

void require_complete(const Snapshot& snapshot) {
    const NodeLattice& nodes = snapshot.nodes;
    if (!(nodes.spacing > 0.0) || std::any_of(nodes.count.begin(), nodes.count.end(), [](std::int64_t count) {
            return count < 2 || count > 1 << 20;
        })) {
        throw VizError(fmt::format(
            "a snapshot needs at least 2 nodes along each axis and a positive spacing, got {} x {} x "
            "{} at {} m",
            nodes.count[0], nodes.count[1], nodes.count[2], nodes.spacing));
    }
    const auto require = [&](const SharedField& field, const char* name) {
        if (!field || static_cast<std::int64_t>(field->size()) != node_count(nodes)) {
            throw VizError(fmt::format("the snapshot's field {} has {} values, its lattice {} nodes", name,
                                       field ? field->size() : 0, node_count(nodes)));
        }
    };
    require(snapshot.phi, "phi");
    require(snapshot.phi_hat, "phi_hat");
    require(snapshot.mass, "mass");
    require(snapshot.temperature, "temperature");
}

std::shared_ptr<const Geometry> make_geometry(const NodeLattice& nodes, const SharedField& phi) {
    auto geometry = std::make_shared<Geometry>();
    geometry->phi = phi;
    geometry->nodes = nodes;
    geometry->free_surface = isosurface(nodes, *phi, 0.0, true, nullptr, nullptr);
    WallBuilder walls(geometry->nodes, *phi);
    for (const std::size_t side : {0U, 1U}) {
        walls.add_face(side, false);
        walls.add_face(side, true);
    }
    walls.add_face(2, true);
    geometry->walls = walls.take();
    geometry->heights = HeightMap(nodes, *phi);
    find_material_box(*geometry);
    return geometry;
}

vtkSmartPointer<vtkDoubleArray> sample_onto(vtkPolyData* points, const NodeLattice& nodes,
                                            const std::vector<double>& field, const char* name) {
    auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetName(name);
    array->SetNumberOfTuples(points->GetNumberOfPoints());
    const FieldSampler sample(nodes, field);
    double position[3];
    for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i) {
        points->GetPoint(i, position);
        array->SetValue(i, sample({position[0], position[1], position[2]}));
    }
    return array;
}

PoolSurfaces make_pool(const Snapshot& snapshot) {
    PoolSurfaces pool{empty_data_set(), empty_data_set(), empty_data_set()};
    const auto box = box_above(snapshot.nodes, *snapshot.temperature, snapshot.liquidus, 2);
    if (!box) {
        return pool;
    }
    const NodeLattice nodes = sub_lattice(snapshot.nodes, *box);
    const auto temperature = sub_field(snapshot.nodes, *snapshot.temperature, *box);
    const auto phi = sub_field(snapshot.nodes, *snapshot.phi, *box);

    const auto isotherm = isosurface(nodes, temperature, snapshot.liquidus, false, &phi, "phi");
    pool.isotherm = clip(isotherm, "phi", 0.0, true);
    pool.isotherm->GetPointData()->RemoveArray("phi");
    vtkNew<vtkDoubleArray> constant;
    constant->SetName(temperature_name);
    constant->SetNumberOfTuples(pool.isotherm->GetNumberOfPoints());
    constant->Fill(snapshot.liquidus);
    pool.isotherm->GetPointData()->SetScalars(constant);

    const auto surface = isosurface(nodes, phi, 0.0, true, &temperature, temperature_name);
    pool.cap = clip(surface, temperature_name, snapshot.liquidus, false);
    pool.line = line_at(surface, snapshot.liquidus);
    return pool;
}

vtkSmartPointer<vtkPolyData> line_at(vtkPolyData* surface, double temperature) {
    auto line = empty_data_set();
    if (surface->GetNumberOfCells() > 0) {
        vtkNew<vtkContourFilter> contour;
        surface->GetPointData()->SetActiveScalars(temperature_name);
        contour->SetInputData(surface);
        contour->SetValue(0, temperature);
        contour->Update();
        line->ShallowCopy(contour->GetOutput());
    }
    return line;
}

vtkSmartPointer<vtkPolyData> join_pool(const PoolSurfaces& pool) {
    vtkNew<vtkAppendPolyData> append;
    for (const auto& [part, is_cap] : {std::pair{pool.isotherm, 0}, std::pair{pool.cap, 1}}) {
        vtkNew<vtkPolyData> marked;
        marked->ShallowCopy(part);
        vtkNew<vtkUnsignedCharArray> mark;
        mark->SetName("free_surface");
        mark->SetNumberOfTuples(part->GetNumberOfCells());
        mark->Fill(is_cap);
        marked->GetCellData()->AddArray(mark);
        append->AddInputData(marked);
    }
    append->Update();
    auto joined = vtkSmartPointer<vtkPolyData>::New();
    joined->ShallowCopy(append->GetOutput());
    if (joined->GetPoints() == nullptr) {
        joined->SetPoints(
            vtkNew<vtkPoints>()); // readers call a file without points broken, one with none is fine
    }
    return joined;
}

vtkSmartPointer<vtkPolyData> make_particles(const ParticleSample& sample) {
    const auto count = static_cast<vtkIdType>(sample.id.size());
    const auto particles = vtkSmartPointer<vtkPolyData>::New();
    vtkNew<vtkDoubleArray> coordinates;
    coordinates->SetNumberOfComponents(3);
    coordinates->SetArray(const_cast<double*>(sample.position.data()), 3 * count, 1);
    vtkNew<vtkPoints> points;
    points->SetData(coordinates);
    particles->SetPoints(points);

    vtkNew<vtkTypeInt32Array> offsets;
    vtkNew<vtkTypeInt32Array> connectivity;
    offsets->SetNumberOfTuples(count + 1);
    connectivity->SetNumberOfTuples(count);
    for (vtkIdType i = 0; i < count; ++i) {
        offsets->SetValue(i, static_cast<vtkTypeInt32>(i));
        connectivity->SetValue(i, static_cast<vtkTypeInt32>(i));
    }
    offsets->SetValue(count, static_cast<vtkTypeInt32>(count));
    vtkNew<vtkCellArray> vertices;
    vertices->SetData(offsets, connectivity);
    particles->SetVerts(vertices);

    vtkPointData* data = particles->GetPointData();
    const auto add = [&](const std::vector<double>& values, const char* name) {
        if (static_cast<vtkIdType>(values.size()) != count) {
            throw VizError(fmt::format("the particle sample has {} values of {} for {} particles",
                                       values.size(), name, count));
        }
        data->AddArray(wrap(values, name));
    };
    add(sample.temperature, temperature_name);
    add(sample.specific_energy, "specific_energy");
    add(sample.liquid_fraction, "liquid_fraction");
    add(sample.phi_hat, "phi_hat");
    if (sample.position.size() != 3 * sample.id.size() || sample.material.size() != sample.id.size()) {
        throw VizError("the particle sample's positions or materials do not fit its number of particles");
    }
    static_assert(sizeof(vtkTypeInt64) == sizeof(std::int64_t) &&
                  sizeof(vtkTypeInt32) == sizeof(std::int32_t));
    vtkNew<vtkTypeInt64Array> ids;
    ids->SetName("id");
    ids->SetArray(reinterpret_cast<vtkTypeInt64*>(const_cast<std::int64_t*>(sample.id.data())), count, 1);
    data->AddArray(ids);
    vtkNew<vtkTypeInt32Array> materials;
    materials->SetName("material");
    materials->SetArray(const_cast<std::int32_t*>(sample.material.data()), count, 1);
    data->AddArray(materials);
    data->SetActiveScalars(temperature_name);
    return particles;
}

vtkSmartPointer<vtkImageData> make_grid(const Snapshot& snapshot) {
    auto grid = make_image(snapshot.nodes);
    grid->GetPointData()->AddArray(wrap(*snapshot.phi, "phi"));
    grid->GetPointData()->AddArray(wrap(*snapshot.phi_hat, "phi_hat"));
    grid->GetPointData()->SetScalars(wrap(*snapshot.temperature, temperature_name));
    grid->GetPointData()->AddArray(wrap(*snapshot.mass, "mass"));
    return grid;
}

Instant make_instant(std::shared_ptr<const Snapshot> snapshot, std::shared_ptr<const Geometry>& geometry) {
    require_complete(*snapshot);
    const auto same_surface = [&] {
        return geometry->phi == snapshot->phi || *geometry->phi == *snapshot->phi;
    };
    if (!geometry || !same_surface()) {
        geometry = make_geometry(snapshot->nodes, snapshot->phi);
    }
    Instant instant;
    instant.geometry = geometry;
    instant.free_surface = vtkSmartPointer<vtkPolyData>::New();
    instant.free_surface->ShallowCopy(geometry->free_surface);
    instant.free_surface->GetPointData()->SetScalars(
        sample_onto(instant.free_surface, snapshot->nodes, *snapshot->temperature, temperature_name));
    instant.pool = make_pool(*snapshot);
    instant.snapshot = std::move(snapshot);
    return instant;
}

} // namespace meltscope::viz
