#include "bench_phases.hpp"

#include "meltscope/run/heat_sources.hpp"

namespace meltscope {
namespace {

StepOptions step_options(const Simulation& s) {
    StepOptions options;
    options.affine = s.parameters.physics.affine_transfer;
    options.energy_gradient = s.parameters.physics.diffuse_energy;
    options.blend = options.affine ? 0.4 : 0.0; // about what advance() takes
    for (const EquationOfState& eos : s.eos)
        options.least_energy.push_back(eos.energy(s.least_temperature));
    return options;
}

} // namespace

const char* phase_name(StepPhase phase) {
    switch (phase) {
    case StepPhase::diffuse:
        return "diffuse";
    case StepPhase::laser:
        return "laser";
    case StepPhase::losses:
        return "losses";
    case StepPhase::update:
        return "update";
    case StepPhase::g2p:
        return "g2p";
    case StepPhase::favre:
        break;
    }
    return "favre";
}

void run_phase(Simulation& s, StepPhase phase) {
    const StepOptions options = step_options(s);
    switch (phase) {
    case StepPhase::diffuse:
        return diffuse(s.grid, s.particles, s.eos, options, s.dt, s.nodes);
    case StepPhase::laser:
        return deposit_laser_heat(s, s.dt);
    case StepPhase::losses:
        return deposit_losses(s, s.dt);
    case StepPhase::update:
        update_grid_energy(s.grid, s.particles, s.eos, s.parameters.boundary, options, s.dt, s.nodes);
        return;
    case StepPhase::g2p:
        return grid_to_particles_to_grid(s.grid, options, s.particles, s.nodes);
    case StepPhase::favre:
        return favre_mean(s.grid, s.eos, s.parameters.boundary, s.nodes);
    }
}

} // namespace meltscope
