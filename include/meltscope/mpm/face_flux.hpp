#pragma once

#include "meltscope/mpm/nodes.hpp"

#include <array>

namespace meltscope {

/// Step 5, faces of the box with the kinds convection and fixed_flux: D_i += dt q N_i dA, q into the
/// material: the flux that is set, or h (T_amb - T). Returns the energy in J that came in through each face.
/// Folds the ghosts of D_i beyond faces that do not fix the temperature, so it is to be called after all
/// other heat has been deposited.
///
/// On the face the B-spline across it has the weights 3/4 (the face's nodes) and 1/8 + 1/8 (the mirror nodes,
/// the ghosts' part folded in). The face is lumped to its nodes: each stands for dx^2, halved at each edge of
/// the box, times the share of its volume that is filled; so a body that covers part of the face gets the
/// area that it covers, and one that ends within a cell of the face, which the grid cannot tell from
/// touching, a part of it. Homogenised powder counts by the solid in it.
///
/// Convection is lumped to the nodes, q N_i dA = h (T_amb - T_i') N_i dA, and implicit: T_i' = T_i + 2 (D_i +
/// what convection adds)/C_i, C_i the node's heat capacity in J/K. So it leads no node beyond the ambient
/// temperature, however large the step, and in a steady state, where D_i ends at zero, its flux does not
/// depend on the step.
std::array<double, 6> deposit_face_fluxes(const Grid& grid, const Boundary& boundary,
                                          const std::vector<EquationOfState>& materials, double dt,
                                          Nodes& nodes);

} // namespace meltscope
