#pragma once

#include "meltscope/run/snapshot.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace meltscope::viz {

/// Number of nodes of a lattice.
std::int64_t node_count(const NodeLattice& lattice);
/// Corner of the last node, m.
Vec3 upper_corner(const NodeLattice& lattice);

/// A view of solver memory as a VTK array of one component, not copied: `field` must outlive the array.
vtkSmartPointer<vtkDoubleArray> wrap(const std::vector<double>& field, const char* name);

/// The lattice as an image without arrays.
vtkSmartPointer<vtkImageData> make_image(const NodeLattice& lattice);

/// Trilinear interpolation of a node field; points outside take the value at the nearest point of the
/// boundary.
class FieldSampler {
  public:
    /// Both must outlive the sampler.
    FieldSampler(const NodeLattice& lattice, const std::vector<double>& field);
    double operator()(const Vec3& point) const;

  private:
    const NodeLattice& lattice_;
    const std::vector<double>& field_;
    double inverse_spacing_;
};

/// A box of nodes, first and last inclusive.
struct NodeBox {
    std::array<std::int64_t, 3> first{};
    std::array<std::int64_t, 3> last{};
};

/// The smallest box of nodes where field >= threshold, grown by `margin` nodes; nothing if there are none.
std::optional<NodeBox> box_above(const NodeLattice& lattice, const std::vector<double>& field,
                                 double threshold, std::int64_t margin);
NodeLattice sub_lattice(const NodeLattice& lattice, const NodeBox& box);
std::vector<double> sub_field(const NodeLattice& lattice, const std::vector<double>& field,
                              const NodeBox& box);

/// Height of the highest free surface over each point of the plane, seen from above.
class HeightMap {
  public:
    HeightMap() = default;
    HeightMap(const NodeLattice& lattice, const std::vector<double>& phi);
    /// From the surface itself, whose points lie on the edges of the lattice.
    HeightMap(const NodeLattice& lattice, vtkPolyData* surface);
    /// Bilinear, m; nothing where there is no material.
    std::optional<double> at(double x, double y) const;

  private:
    NodeLattice lattice_;
    std::vector<double> height_; ///< m, one a column, NaN without material
};

} // namespace meltscope::viz
