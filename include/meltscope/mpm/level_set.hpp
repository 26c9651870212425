#pragma once

#include "meltscope/mpm/particles.hpp"

namespace meltscope {

/// How the free surface is found and smoothed.
struct LevelSetOptions {
    double radius = 1.0;  ///< spacings; a particle that stands alone is a ball of (radius - 1/2) spacings
    double epsilon = 0.5; ///< cells; width of the regularised level set
};

/// Half width of the band in which distances are exact, in cells; beyond it phi is plus or minus this.
inline constexpr double level_set_band = 6.0;

/// Step 1: signed distance phi_i in m from the nodes to the free surface, negative in the material.
///
/// The surface is where the volume fraction sum_p N_ip v_p / dx^3 is one half: smoothed by the B-spline,
/// whose profile across a plane is known in closed form, so that distances near the surface come from
/// inverting it, free of the bias and the bumps of distances to single particles. Further off the distance is
/// that to the nearest of the foot points of the nodes near the surface. Where the fraction leaves a particle
/// outside, the particle is a ball. The box's faces are no free surfaces: the material is continued beyond
/// them as its mirror image.
Field signed_distance(const Grid& grid, const Particles& particles, const LevelSetOptions& options);

/// Step 2: phi_hat_i = 1/2 - 1/(1 + exp(phi_i/eps)), eps = epsilon dx; -1/2 deep inside, 1/2 far outside.
Field regularized(const Grid& grid, const Field& phi, const LevelSetOptions& options);

/// Distance in cells (positive outside) at which the quadratic B-spline smooths a half space to `fraction`.
double distance_of_fraction(double fraction);

} // namespace meltscope
