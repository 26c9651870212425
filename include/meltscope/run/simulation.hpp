#pragma once

#include "meltscope/beam/illumination.hpp"
#include "meltscope/beam/radiative_exchange.hpp"
#include "meltscope/beam/surface_losses.hpp"
#include "meltscope/material/equation_of_state.hpp"
#include "meltscope/mpm/awake_bricks.hpp"
#include "meltscope/mpm/free_surface.hpp"
#include "meltscope/mpm/thermal_step.hpp"
#include "meltscope/run/ledger.hpp"

#include <optional>
#include <string>
#include <vector>

namespace meltscope {

/// K; a larger tolerance for what is quiescent would be no error but a slip.
inline constexpr double highest_quiescent_tolerance = 10.0;

/// Which numerical forms and physical effects are on. Steerable between steps, but for transfer and deposit.
struct PhysicsOptions {
    bool affine_transfer = true;      ///< false: the values alone (FLIP)
    bool deposit_at_surface = true;   ///< false: in the band, at the particles
    bool diffuse_energy = false;      ///< F = -(kappa/c) grad e; one material only
    std::optional<double> blend_time; ///< s, tau of b = min(1, dt/tau); default: dx^2/alpha_max, of
                                      ///< homogenised powder if there is any (affine), never (flip)
    bool radiation = false;
    bool evaporation = false;
    bool reabsorption = false;
    double convection = 0.0; ///< W/m^2/K, h of the free surface; zero: none
    double ambient = 298.15; ///< K
    /// K: where all is still at its start temperature within this, no work is done; 0: work everywhere
    double quiescent_tolerance = 1e-6;
};

/// How time advances.
struct TimeOptions {
    double end = 0.0;               ///< s
    double cfl = 0.5;               ///< share of the explicit limit, in (0, 1]
    std::optional<double> max_step; ///< s
};

/// Everything about a run that is given and not computed. A plain value; what a console changes is in here.
struct RunParameters {
    std::string title;
    std::vector<Material> materials;
    Boundary boundary;
    std::vector<Laser> lasers;
    PhysicsOptions physics;
    LevelSetOptions level_set;
    TimeOptions time;
    std::vector<double> isotherms; ///< K, at which the melt pool is measured
};

/// What ruled the size of a step.
enum class StepLimit { diffusion, beam, max_step, landing };

/// What sleeps because it is still at its start temperature.
struct Quiescence {
    Bricks bricks;                ///< no bricks: nothing sleeps
    std::vector<char> at_surface; ///< of each brick: it shares nodes with surface elements
    Field mass_of_all;            ///< kg, the nodes' masses, of those asleep too
    double looked_with = -1.0;    ///< K: with this tolerance all that sleeps has been found quiet
};

/// A run in progress: given parameters, state, and what is derived from both. The state proper is time, step,
/// ledger, particles, the nodes' mass-energy (m e)_i, which carries what step 3 has gathered for the next
/// step, the least temperature and which bricks are awake.
struct Simulation {
    RunParameters parameters;
    Grid grid;

    double time = 0.0; ///< s
    std::int64_t step = 0;
    double dt = 0.0;                        ///< s, of the last step
    StepLimit limit = StepLimit::diffusion; ///< of the last step
    Ledger ledger;
    Particles particles;
    Nodes nodes;
    /// K, than which nothing in the run so far makes the material colder: of what it started with, of what
    /// was added, of the faces and of the surroundings. 0 once a face has drawn heat off at a fixed flux.
    double least_temperature = 0.0;
    Quiescence quiescence;

    // Derived from the parameters and the particles' places; made anew when these change.
    std::vector<EquationOfState> eos;
    double least_packing = 1.0;      ///< density of the lightest homogenised powder by that of its bulk
    double powder_diffusivity = 0.0; ///< m^2/s, largest of homogenised powder that has not melted; inf: none
    FreeSurface surface;
    std::vector<LightMap> light_maps;          ///< one a laser
    std::vector<LossLaw> loss_laws;            ///< one a material; empty while no loss is on
    LossElements loss_elements;                ///< set while a loss is on
    std::optional<RadiativeExchange> exchange; ///< set while reabsorption is on

    // Of the last step, for the log and the tables.
    double peak_temperature = 0.0;      ///< K, hottest particle, rounded up to a kelvin
    double coldest_temperature = 0.0;   ///< K, coldest particle, rounded down to a kelvin
    std::vector<Absorption> absorption; ///< one a laser
    double seconds_in_level_set = 0.0;  ///< wall time spent on the free surface and the light maps
};

/// Starts a run. `lattice`: points a cell along an axis that `particles` sit on, 0 for none (see
/// make_lane_layout). Throws std::invalid_argument for parameters that make no sense together,
/// std::out_of_range for particles outside.
Simulation make_simulation(RunParameters parameters, const Grid& grid, ParticleList particles, int lattice);

/// Goes on from a saved state: as make_simulation, then time, step, dt, ledger, the mass-energy of the nodes
/// (grid.size doubles as saved from nodes.mass_energy) and the least temperature are put back. `awake`: as
/// saved from quiescence.bricks.awake; empty if all were.
Simulation resume_simulation(RunParameters parameters, const Grid& grid, ParticleList particles, int lattice,
                             double time, std::int64_t step, double dt, const Ledger& ledger,
                             const Field& mass_energy, double least_temperature,
                             std::vector<char> awake = {});

/// The largest step that is stable and follows the beams, s, and which limit rules.
double largest_step(const Simulation& simulation, StepLimit& limit);

/// One step, towards `target` (s, later than now) and never beyond it; lands on it and on the corners of the
/// scan paths exactly. Steps 3 to 7 of the method; see simulation.cpp.
void advance(Simulation& simulation, double target);

/// Makes the free surface and the light maps anew after a laser's direction, the lasers or the level-set
/// options were changed.
void update_geometry(Simulation& simulation);

/// Takes over changed losses: radiation, evaporation, reabsorption, convection, ambient. Throws
/// std::invalid_argument if a material lacks what a loss needs; the simulation is then as before.
void update_losses(Simulation& simulation);

/// Makes the nodes anew after face conditions were changed.
void update_boundary(Simulation& simulation);

/// Adds particles (a powder layer) at their own energies; ids must go on from the last. The energies of those
/// that are there are untouched. Throws std::out_of_range if one lies outside the box.
void add_particles(Simulation& simulation, const ParticleList& more);

/// Works out what the particles hold now and puts it into the ledger.
void balance(Simulation& simulation);

/// Largest difference, K, between the temperature of a particle's own energy and that interpolated from the
/// nodes.
double energy_spread(const Simulation& simulation);

/// The nodes' masses in kg, of all particles whether they are awake or not.
const Field& node_masses(const Simulation& simulation);

/// Power in W that a laser emits at a time, and where its beam is.
BeamPosition beam_now(const Laser& laser, double time, double& power);

} // namespace meltscope
