#pragma once

#include "meltscope/mpm/free_surface.hpp"

#include <span>
#include <vector>

namespace meltscope {

/// Which ways the free surface loses heat.
struct LossOptions {
    bool radiation = false;
    bool evaporation = false;
    double convection = 0.0; ///< W/m^2/K, h of free surfaces; zero: none
    double ambient = 298.15; ///< K, T_amb

    bool any() const { return radiation || evaporation || convection > 0.0; }
};

/// Constants of one material's losses; see loss_flux.
struct LossLaw {
    double ambient = 0.0;                 ///< K
    double convection = 0.0;              ///< W/m^2/K
    double radiation = 0.0;               ///< W/m^2/K^4, emissivity x Stefan-Boltzmann constant
    double evaporation = 0.0;             ///< W K^(1/2)/m^2, L_v 0.82 p_atm sqrt(M/(2 pi R)); zero: none
    double evaporation_temperature = 0.0; ///< K, L_v M/R
    double inverse_boiling_point = 0.0;   ///< 1/K
    double evaporation_onset = 0.0;       ///< K, below it evaporation is zero
};

/// At its onset the evaporative flux is this share of that at the boiling point; what lies below is dropped.
inline constexpr double dropped_evaporation = 1e-12;

/// Fluxes in W/m^2 out of the material.
struct LossFlux {
    double radiation = 0.0;
    double convection = 0.0;
    double evaporation = 0.0;
};

/// The laws of all materials. Throws std::invalid_argument that names the material and the key that a
/// switched-on loss lacks, or a value that makes no sense.
std::vector<LossLaw> make_loss_laws(const std::vector<Material>& materials, const LossOptions& options);

/// Losses of a surface at T (K):
///   radiation    emissivity sigma (T^4 - T_amb^4)
///   convection   h (T - T_amb)
///   evaporation  L_v 0.82 p_sat sqrt(M/(2 pi R T)), p_sat = p_atm exp[L_v M (T - T_b)/(R T T_b)], into
///   vacuum but for the
///                share of atoms that come back (0.82: Anisimov 1968; Knight 1979). Above the ambient
///                temperature only.
LossFlux loss_flux(const LossLaw& law, double temperature);

/// What the surface loses over a step, J.
struct LossEnergy {
    double radiated = 0.0;
    double convected = 0.0;
    double evaporated = 0.0;

    double total() const { return radiated + convected + evaporated; }
};

/// What a surface element of area a (m^2) that stands for the mass M (kg) loses in `dt` (s); T in K, and
/// `gain` in J/kg is what else it is about to take in.
///
/// Implicit: the flux is that at the temperature T' at which the element ends,
///   e(T') = e(T) + gain - q(T') a dt/M.
/// So a loss never takes an element beyond the ambient temperature, however large the step, and a steady
/// state, where gain and loss cancel, has the flux q(T) whatever the step. The radiative flux is q = s (T' -
/// T_amb) with the s = emissivity sigma (T^2 + T_amb^2)(T + T_amb) of the step's start.
LossEnergy element_loss(const LossLaw& law, const EquationOfState& eos, double area, double mass,
                        double temperature, double gain, double dt);

/// What the surface elements may draw on. Stands as long as the geometry.
struct LossElements {
    Field area, mass;               ///< a_s in m^2 and M_s in kg, in the layout's order; padding has no area
    std::vector<std::int64_t> near; ///< nodes with mass that the elements reach, ascending
    Field gain;                     ///< J/kg, nodal: D_i/m_i of the step under way
    std::vector<char> awake;        ///< lane groups that lose heat; empty: all
};

/// The mass M_s that an element stands for: heat spread evenly over the surface, q a_s an element, raises the
/// specific energy at x_s by q a_s/M_s. With w_is = N_i(x_s)/sum_j N_j(x_s),
///   a_s/M_s = sum_i w_is (sum_q w_iq a_q) / m_i.
LossElements make_loss_elements(const Grid& grid, const Boundary& boundary, const SurfaceElements& elements,
                                const Nodes& nodes);

/// Step 5, losses: takes from D_i what the elements lose in `dt` (s), each at T = sum_i w_is T_i with the
/// gain sum_i w_is D_i/m_i. After all other heat of the step has been deposited; folds the ghosts of D_i
/// beyond faces that do not fix the temperature. Each element's law is that of its material.
LossEnergy deposit_losses(const Grid& grid, const Boundary& boundary, std::span<const LossLaw> laws,
                          const std::vector<EquationOfState>& eos, const SurfaceElements& elements, double dt,
                          LossElements& loss, Nodes& nodes);

} // namespace meltscope
