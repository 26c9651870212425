#pragma once

#include "meltscope/mpm/nodes.hpp"

#include <functional>

namespace meltscope {

/// Which form of the step is taken.
struct StepOptions {
    bool affine = true;           ///< carry energy gradients to the nodes; false: the values alone (FLIP)
    bool energy_gradient = false; ///< F = -(kappa/c) grad e instead of -kappa grad T
    double blend = 0.0;           ///< b: share of the nodes' own energy in the particles' new one, 0 .. 1
    /// J/kg, of each material at the lowest temperature that anything in the run can bring about: the affine
    /// transfer is held back where it would go below. Empty: it never is.
    std::vector<double> least_energy;
};

/// Step 5, diffusion: D_i += dt sum_p v_p F_p . grad N_ip, F_p = -kappa(T_p) sum_i T_i grad N_ip.
/// With `energy_gradient`, F_p = -(kappa/c) sum_i e(T_i) grad N_ip (one material only).
/// Homogenised powder has the powder's kappa; what reaches the liquidus becomes bulk for good.
void diffuse(const Grid& grid, Particles& particles, const std::vector<EquationOfState>& materials,
             const StepOptions& options, double dt, Nodes& nodes);

/// Step 6: e_i* = e_i + D_i / m_i, then the faces of fixed temperature; ghosts follow. With the affine
/// transfer D_i is first freed of what lumping the mass does to it, |q_i| <= e_i - least energy. Returns the
/// energy in J that those faces conducted into the material. Leaves D_i and (m e)_i zero and prepares the
/// blend of step 7.
double update_grid_energy(const Grid& grid, const Particles& particles,
                          const std::vector<EquationOfState>& materials, const Boundary& boundary,
                          const StepOptions& options, double dt, Nodes& nodes);

/// Step 7, G2P, and step 3 of the next step in the same pass:
/// e_p <- (1 - b) [e_p + sum_i N_ip (e_i* - e_i)] + b sum_i N_ip e_i*, g_p = sum_i e_i* grad N_ip,
/// (m e)_i = sum_p N_ip m_p (e_p + g_p . (x_i - x_p)). g_p is shortened where 0.6 cells along it would
/// lead below the least energy; energy is conserved for any g_p.
void grid_to_particles_to_grid(const Grid& grid, const StepOptions& options, Particles& particles,
                               Nodes& nodes);

/// sum_i f_i N_ip of a nodal field at the particles, in layout order.
Field interpolate_to_particles(const Grid& grid, const Particles& particles, const Field& nodal);

/// The same of the temperature, K.
inline Field particle_temperatures(const Grid& grid, const Particles& particles, const Nodes& nodes) {
    return interpolate_to_particles(grid, particles, nodes.temperature);
}

} // namespace meltscope
