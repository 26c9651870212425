#pragma once

#include "meltscope/run/simulation.hpp"

/// Step 5, the heat that does not come by conduction: what goes into D_i over a step of `dt` (s), and into
/// the ledger. In this order: losses are implicit in the temperature to which all other heat of the surface
/// leads.
namespace meltscope {

/// The lasers': what each surface element absorbs, or each particle that a volumetric beam reaches.
void deposit_laser_heat(Simulation& simulation, double dt);

/// What the free surface loses, and what it takes in again of its own radiation.
void deposit_losses(Simulation& simulation, double dt);

/// Through faces of the box that convect or have a flux set.
void deposit_face_heat(Simulation& simulation, double dt);

} // namespace meltscope
