#pragma once

#include "meltscope/beam/illumination.hpp"
#include "meltscope/mpm/nodes.hpp"
#include "meltscope/mpm/particles.hpp"

namespace meltscope {

/// Step 5, volumetric beam: D_i += dt sum_p N_ip S_p v_p with the power density S_p of volume_source(laser,
/// beam), the laser emitting `power` W, without the gate to the surface. Scaled so that the sum is
/// absorptivity x power x share of the beam's footprint that meets material (`map`, of the laser's direction)
/// exactly; all is missed if no particle lies within the source's reach. The result's scale says by how much.
/// Throws std::invalid_argument for a laser without spot radius or depth.
Absorption deposit_volume(const Grid& grid, const Particles& particles, const LightMap& map,
                          const Laser& laser, const BeamPosition& beam, double power, double dt,
                          Nodes& nodes);

} // namespace meltscope
