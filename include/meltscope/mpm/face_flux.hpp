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
/// touching, a part of it. Convection is implicit in the face's own temperature: q = h (T_amb - T'), with the
/// end T' = T + [sum_i w_i D_i/m_i + q dA dt/m]/c, 1/m = sum_i w_i^2/m_i; it never goes beyond the ambient
/// temperature.
std::array<double, 6> deposit_face_fluxes(const Grid& grid, const Boundary& boundary,
                                          const std::vector<EquationOfState>& materials, double dt,
                                          Nodes& nodes);

} // namespace meltscope
