#include "scratch.hpp"
#include "synthetic.hpp"
#include "viz/data_sets.hpp"
#include "viz/file_output.hpp"
#include "viz/options.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include <vtkCellData.h>
#include <vtkMassProperties.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkTriangle.h>
#include <vtkTriangleFilter.h>

namespace meltscope::viz {
namespace {

NodeLattice cube(std::int64_t nodes, double side) {
    NodeLattice lattice;
    lattice.spacing = side / static_cast<double>(nodes - 1);
    lattice.origin = Vec3::Constant(-0.5 * side);
    lattice.count = {nodes, nodes, nodes};
    return lattice;
}

template <class Function>
std::vector<double> on_nodes(const NodeLattice& lattice, Function function) {
    std::vector<double> field;
    for (std::int64_t k = 0; k < lattice.count[2]; ++k) {
        for (std::int64_t j = 0; j < lattice.count[1]; ++j) {
            for (std::int64_t i = 0; i < lattice.count[0]; ++i) {
                field.push_back(function(Vec3(
                    lattice.origin + lattice.spacing * Vec3(static_cast<double>(i), static_cast<double>(j),
                                                            static_cast<double>(k)))));
            }
        }
    }
    return field;
}

SharedField shared(std::vector<double> field) {
    return std::make_shared<const std::vector<double>>(std::move(field));
}

/// How far triangles and point normals turn away from `outward`, as the smallest cosine.
template <class Outward>
double worst_cosine(vtkPolyData* surface, Outward outward) {
    double worst = 1.0;
    vtkDataArray* normals = surface->GetPointData()->GetNormals();
    for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
        const double* point = surface->GetPoint(i);
        const Vec3 direction = outward(Vec3(point[0], point[1], point[2]));
        const double* normal = normals->GetTuple(i);
        worst = std::min(worst, direction.dot(Vec3(normal[0], normal[1], normal[2])));
    }
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(surface);
    triangles->Update();
    vtkPolyData* split = triangles->GetOutput();
    for (vtkIdType i = 0; i < split->GetNumberOfCells(); ++i) {
        vtkCell* cell = split->GetCell(i);
        double corners[3][3];
        double normal[3];
        for (int c = 0; c < 3; ++c) {
            split->GetPoint(cell->GetPointId(c), corners[c]);
        }
        vtkTriangle::ComputeNormal(corners[0], corners[1], corners[2], normal);
        const Vec3 center((corners[0][0] + corners[1][0] + corners[2][0]) / 3.0,
                          (corners[0][1] + corners[1][1] + corners[2][1]) / 3.0,
                          (corners[0][2] + corners[1][2] + corners[2][2]) / 3.0);
        const Vec3 found(normal[0], normal[1], normal[2]);
        if (found.norm() > 0.5) { // slivers have no direction
            worst = std::min(worst, outward(center).dot(found));
        }
    }
    return worst;
}

double volume_of(vtkPolyData* closed) {
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(closed);
    vtkNew<vtkMassProperties> mass;
    mass->SetInputConnection(triangles->GetOutputPort());
    mass->Update();
    return mass->GetVolume();
}

double area_of(vtkPolyData* surface) {
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(surface);
    vtkNew<vtkMassProperties> mass;
    mass->SetInputConnection(triangles->GetOutputPort());
    mass->Update();
    return mass->GetSurfaceArea();
}

TEST(DataSets, trilinear_fields_are_sampled_exactly) {
    const NodeLattice lattice = cube(6, 1.0);
    const auto linear = [](const Vec3& x) { return 3.0 + x.x() - 2.0 * x.y() + 0.5 * x.z() + x.x() * x.y(); };
    const auto field = on_nodes(lattice, linear);
    const FieldSampler sample(lattice, field);
    for (const Vec3& x : {Vec3(0.11, -0.23, 0.37), Vec3(0.5, 0.5, 0.5), Vec3(-0.5, 0.1, -0.5)}) {
        EXPECT_NEAR(sample(x), linear(x), 1e-12);
    }
    EXPECT_NEAR(sample(Vec3(9.0, 0.0, 0.0)), linear(Vec3(0.5, 0.0, 0.0)), 1e-12);
}

TEST(DataSets, free_surface_of_a_ball_lies_on_it_and_faces_outwards) {
    const double radius = 30e-6;
    const NodeLattice lattice = cube(41, 100e-6);
    const auto geometry =
        make_geometry(lattice, shared(on_nodes(lattice, [&](const Vec3& x) { return x.norm() - radius; })));
    vtkPolyData* surface = geometry->free_surface;
    ASSERT_GT(surface->GetNumberOfPoints(), 1000);
    for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
        const double* x = surface->GetPoint(i);
        EXPECT_NEAR(Vec3(x[0], x[1], x[2]).norm(), radius, 0.02 * lattice.spacing * 10);
    }
    EXPECT_GT(worst_cosine(surface, [](const Vec3& x) { return Vec3(x.normalized()); }), 0.95);
    EXPECT_EQ(geometry->walls->GetNumberOfCells(), 0);
    EXPECT_NEAR(geometry->upper.x(), radius, 0.1 * lattice.spacing);
}

TEST(DataSets, walls_of_a_plate_have_the_area_of_its_sides) {
    const NodeLattice lattice = cube(21, 1e-3);
    const double top = 0.13e-3; // between nodes
    const auto geometry =
        make_geometry(lattice, shared(on_nodes(lattice, [&](const Vec3& x) { return x.z() - top; })));
    EXPECT_NEAR(area_of(geometry->walls), 4.0 * 1e-3 * (0.5e-3 + top), 1e-4 * 1e-6);
    EXPECT_NEAR(area_of(geometry->free_surface), 1e-3 * 1e-3, 1e-4 * 1e-6);
    // On the wall that a normal belongs to, the position along the normal is half the side.
    EXPECT_GT(worst_cosine(geometry->walls, [](const Vec3& x) { return Vec3(x / 0.5e-3); }), 0.999);
    EXPECT_NEAR(geometry->heights.at(0.0, 0.0).value(), top, 1e-12);
}

TEST(DataSets, pool_of_an_ellipsoid_cut_by_the_surface_has_its_volume) {
    // T falls linearly with the ellipsoid's radius; the half below z = 0 is the pool.
    const Vec3 axes(90e-6, 45e-6, 30e-6);
    Snapshot snapshot;
    snapshot.nodes = cube(81, 240e-6);
    snapshot.liquidus = 1600.0;
    snapshot.solidus = 1550.0;
    snapshot.phi = shared(on_nodes(snapshot.nodes, [](const Vec3& x) { return x.z(); }));
    snapshot.temperature = shared(on_nodes(snapshot.nodes, [&](const Vec3& x) {
        return 1600.0 + 1000.0 * (1.0 - x.cwiseQuotient(axes).norm());
    }));
    const PoolSurfaces pool = make_pool(snapshot);
    ASSERT_GT(pool.isotherm->GetNumberOfCells(), 100);
    ASSERT_GT(pool.cap->GetNumberOfCells(), 100);
    ASSERT_GT(pool.line->GetNumberOfCells(), 10);
    const double expected = 2.0 / 3.0 * constants::pi * axes.prod();
    EXPECT_NEAR(volume_of(join_pool(pool)), expected, 0.02 * expected);
    EXPECT_GT(worst_cosine(
                  pool.isotherm,
                  [&](const Vec3& x) { return Vec3(x.cwiseQuotient(axes.cwiseProduct(axes)).normalized()); }),
              0.8);
    for (vtkIdType i = 0; i < pool.line->GetNumberOfPoints(); ++i) {
        const double* x = pool.line->GetPoint(i);
        EXPECT_NEAR(std::hypot(x[0] / axes.x(), x[1] / axes.y()), 1.0, 0.02);
    }
}

TEST(DataSets, a_cold_part_has_no_pool) {
    test::SyntheticPlate plate;
    plate.count = {31, 21, 15};
    auto snapshot = test::make_snapshot(plate, 0.0);
    snapshot->liquidus = 1e5;
    const PoolSurfaces pool = make_pool(*snapshot);
    EXPECT_EQ(
        pool.isotherm->GetNumberOfCells() + pool.cap->GetNumberOfCells() + pool.line->GetNumberOfCells(), 0);
    EXPECT_EQ(join_pool(pool)->GetNumberOfCells(), 0);
}

TEST(DataSets, grid_and_particles_wrap_the_solver_memory) {
    test::SyntheticPlate plate;
    plate.count = {31, 21, 15};
    const auto snapshot = test::make_snapshot(plate, 0.0);
    EXPECT_EQ(make_grid(*snapshot)->GetPointData()->GetArray("temperature")->GetVoidPointer(0),
              snapshot->temperature->data());
    const auto particles = make_particles(snapshot->particles);
    EXPECT_EQ(particles->GetPoints()->GetData()->GetVoidPointer(0), snapshot->particles.position.data());
    EXPECT_EQ(particles->GetPointData()->GetArray("id")->GetVoidPointer(0), snapshot->particles.id.data());
}

TEST(DataSets, geometry_is_made_once_while_the_level_set_is_the_same) {
    test::SyntheticPlate plate;
    plate.count = {31, 21, 15};
    std::shared_ptr<const Geometry> geometry;
    const Instant first = make_instant(test::make_snapshot(plate, 0.0), geometry);
    const Instant second = make_instant(test::make_snapshot(plate, 1e-5), geometry);
    EXPECT_EQ(first.geometry, second.geometry);
    plate.phi = nullptr; // the same values in memory of their own, as every snapshot of a run has them
    const Instant third = make_instant(test::make_snapshot(plate, 2e-5), geometry);
    EXPECT_EQ(first.geometry, third.geometry);
    plate.phi = nullptr;
    plate.roughness = 3e-6;
    const Instant rough = make_instant(test::make_snapshot(plate, 3e-5), geometry);
    EXPECT_NE(first.geometry, rough.geometry);
}

TEST(DataSets, writing_files_leaves_the_data_sets_as_they_were) {
    const test::ScratchFolder scratch;
    test::SyntheticPlate plate;
    plate.count = {31, 21, 15};
    std::shared_ptr<const Geometry> geometry;
    const Instant instant = make_instant(test::make_snapshot(plate, 0.0), geometry);
    const auto triangles = instant.free_surface->GetNumberOfPolys();
    ASSERT_GT(triangles, 0);
    FileOptions options;
    options.run_dir = scratch.path();
    FileOutput output(options);
    output.write(instant);
    EXPECT_EQ(instant.free_surface->GetNumberOfPolys(), triangles);
    EXPECT_EQ(geometry->free_surface->GetNumberOfPolys(), triangles);
}

TEST(DataSets, incomplete_snapshots_are_refused) {
    test::SyntheticPlate plate;
    plate.count = {31, 21, 15};
    const auto snapshot = test::make_snapshot(plate, 0.0);
    snapshot->mass = nullptr;
    EXPECT_THROW(require_complete(*snapshot), VizError);
    snapshot->mass = snapshot->phi;
    EXPECT_NO_THROW(require_complete(*snapshot));
    snapshot->nodes.count[2] = 7;
    EXPECT_THROW(require_complete(*snapshot), VizError);
}

} // namespace
} // namespace meltscope::viz
