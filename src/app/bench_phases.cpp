#include "bench_phases.hpp"

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

void deposit_laser_heat(Simulation& s) {
    std::vector<double> energy(std::size_t(s.surface.elements.count()), 0.0);
    for (std::size_t l = 0; l < s.parameters.lasers.size(); ++l) {
        const Laser& laser = s.parameters.lasers[l];
        double power = 0.0;
        const BeamPosition beam = beam_now(laser, s.time, power);
        if (power > 0.0 && laser.profile != BeamProfile::volumetric)
            absorb(s.light_maps[l], laser, beam.position, power, s.surface.elements, energy);
    }
    for (double& e : energy)
        e *= s.dt;
    deposit(s.grid, s.surface.elements, energy, s.nodes);
}

void deposit_losses(Simulation& s) {
    if (s.loss_laws.empty())
        return;
    const SurfaceElements& elements = s.surface.elements;
    std::vector<double> temperature, gain, energy(std::size_t(elements.count()), 0.0);
    surface_temperatures(s.grid, elements, s.nodes, temperature);
    surface_gains(s.grid, s.parameters.boundary, elements, s.loss_elements, s.nodes, gain);
    lose_heat(s.loss_laws, s.eos, elements, s.loss_elements, temperature, gain, s.dt, energy);
    deposit(s.grid, elements, energy, s.nodes);
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
        return deposit_laser_heat(s);
    case StepPhase::losses:
        return deposit_losses(s);
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
