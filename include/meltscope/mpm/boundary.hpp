#pragma once

#include "meltscope/aligned.hpp"
#include "meltscope/mpm/grid.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace meltscope {

/// What happens at one face of the box.
struct FaceCondition {
    enum class Kind { adiabatic, fixed_temperature, convection, fixed_flux };
    Kind kind = Kind::adiabatic;
    double temperature = 0.0; ///< K: of the face, or of what lies beyond it (convection)
    double coefficient = 0.0; ///< W/m^2/K, convection
    double flux = 0.0;        ///< W/m^2 into the material

    bool fixes_temperature() const { return kind == Kind::fixed_temperature; }
};

/// Conditions at x_min, x_max, y_min, y_max, z_min, z_max.
using Boundary = std::array<FaceCondition, 6>;

/// One face of the box seen from the storage of a nodal field: planes of nodes normal to `axis`.
struct FacePlanes {
    int axis = 0;
    std::int64_t ghost = 0;  ///< storage coordinate along the axis of the ghost plane
    std::int64_t face = 0;   ///< of the plane on the face
    std::int64_t mirror = 0; ///< of the plane inside that mirrors the ghost plane
};

/// Planes of face f (0 .. 5 in the order of Boundary).
FacePlanes face_planes(const Grid& grid, int f);

/// Calls work(a, b, c) for every node of the face's planes, ghosts of the other axes included: a, b, c are
/// the storage indices of the ghost node, the face node and the mirror node that share the other two
/// coordinates.
///
/// Threads that call it together share the nodes, and none goes on before all are done.
template <class Work>
void for_each_face_node(const Grid& grid, int f, Work work) {
    const FacePlanes planes = face_planes(grid, f);
    const std::array<std::int64_t, 3> stride{1, grid.stride_y, grid.stride_z};
    const int u = planes.axis == 0 ? 1 : 0, v = planes.axis == 2 ? 1 : 2;
    const std::int64_t step = stride[planes.axis];
#pragma omp for schedule(static)
    for (std::int64_t q = 0; q < grid.cells[v] + 3; ++q)
        for (std::int64_t p = 0; p < grid.cells[u] + 3; ++p) {
            const std::int64_t base = p * stride[u] + q * stride[v];
            work(base + planes.ghost * step, base + planes.face * step, base + planes.mirror * step);
        }
}

/// Adds what was scattered to ghost nodes beyond an adiabatic face to their mirror nodes and clears the
/// ghosts: the field then is what particles mirrored at the face would give. Beyond a face of fixed
/// temperature it is left alone, or, with `odd_at_fixed`, taken off the mirror node (the flux of an odd
/// temperature), or added (`even_at_fixed`).
enum class AtFixedFaces { leave, odd, even };
void fold_ghosts(const Grid& grid, const Boundary& boundary, AtFixedFaces at_fixed, Field& field);

/// Copies mirror nodes to the ghosts beyond all faces that do not fix the temperature.
void mirror_ghosts(const Grid& grid, const Boundary& boundary, Field& field);

/// Storage indices of all nodes on and next to faces of fixed temperature (planes ghost, face and mirror),
/// each once, ascending.
std::vector<std::int64_t> nodes_near_fixed_faces(const Grid& grid, const Boundary& boundary);

} // namespace meltscope
