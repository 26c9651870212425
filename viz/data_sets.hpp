#pragma once

#include "viz/lattice.hpp"

#include "meltscope/run/snapshot.hpp"

#include <array>
#include <memory>
#include <string>

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace meltscope::viz {

/// What follows from the level set alone; made again only when the level set is another one.
struct Geometry {
    SharedField phi;
    NodeLattice nodes;
    vtkSmartPointer<vtkPolyData> free_surface; ///< phi = 0 with outward point normals
    vtkSmartPointer<vtkPolyData> walls; ///< where the domain's sides and top cut the material, with normals
    HeightMap heights;
    Vec3 lower = Vec3::Zero(); ///< m, box around the material
    Vec3 upper = Vec3::Zero(); ///< m
};

/// The molten pool as surfaces; empty data sets when nothing is molten.
struct PoolSurfaces {
    vtkSmartPointer<vtkPolyData> isotherm; ///< the liquidus isosurface inside the material, outward normals
    vtkSmartPointer<vtkPolyData> cap;      ///< the free surface above liquidus, outward normals
    vtkSmartPointer<vtkPolyData> line;     ///< where the two meet: liquidus on the free surface
};

/// Throws VizError if a field that pictures and files need is missing or has not one value a node.
void require_complete(const Snapshot& snapshot);

std::shared_ptr<const Geometry> make_geometry(const NodeLattice& nodes, const SharedField& phi);

/// Values of a node field at the points of a data set, under that name.
vtkSmartPointer<vtkDoubleArray> sample_onto(vtkPolyData* points, const NodeLattice& nodes,
                                            const std::vector<double>& field, const char* name);

/// Both parts carry `temperature`.
PoolSurfaces make_pool(const Snapshot& snapshot);

/// The line on a surface with `temperature` where it has that value, K.
vtkSmartPointer<vtkPolyData> line_at(vtkPolyData* surface, double temperature);

/// The two parts of the pool as one data set, with the cell array `free_surface` (1 on the cap, 0 on the
/// isotherm).
vtkSmartPointer<vtkPolyData> join_pool(const PoolSurfaces& pool);

/// Particles as points with a vertex each and all arrays of the sample, wrapping its memory where the layout
/// is VTK's: the sample must outlive the result.
vtkSmartPointer<vtkPolyData> make_particles(const ParticleSample& sample);

/// phi, phi_hat, temperature, mass on the nodes, wrapping the snapshot's memory.
vtkSmartPointer<vtkImageData> make_grid(const Snapshot& snapshot);

/// One instant as files and pictures share it.
struct Instant {
    std::shared_ptr<const Snapshot> snapshot;
    std::shared_ptr<const Geometry> geometry;
    vtkSmartPointer<vtkPolyData> free_surface; ///< with `temperature`
    PoolSurfaces pool;
};

/// `geometry` is kept by the caller from one instant to the next; it is made anew when the surface has
/// changed.
Instant make_instant(std::shared_ptr<const Snapshot> snapshot, std::shared_ptr<const Geometry>& geometry);

} // namespace meltscope::viz
