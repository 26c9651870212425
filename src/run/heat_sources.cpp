#include "meltscope/run/heat_sources.hpp"

#include "meltscope/beam/volume_heating.hpp"
#include "meltscope/mpm/face_flux.hpp"

#include <algorithm>

namespace meltscope {

void deposit_laser_heat(Simulation& s, double dt) {
    const SurfaceElements& elements = s.surface.elements;
    ElementHeat heat; // W, then J
    s.absorption.assign(s.parameters.lasers.size(), {});
    for (std::size_t l = 0; l < s.parameters.lasers.size(); ++l) {
        const Laser& laser = s.parameters.lasers[l];
        double power = 0.0;
        const BeamPosition beam = beam_now(laser, s.time + 0.5 * dt, power);
        if (power <= 0.0)
            continue;
        const bool at_surface = laser.profile != BeamProfile::volumetric;
        const Absorption a = at_surface ? absorb(s.light_maps[l], laser, beam.position, power, elements, heat)
                                        : deposit_volume(s.grid, s.particles, s.light_maps[l], laser, beam,
                                                         power, dt, s.nodes);
        s.absorption[l] = a;
        s.ledger.emitted += power * dt;
        s.ledger.absorbed += a.absorbed * dt;
        s.ledger.missed += a.missed * dt;
        s.ledger.reflected += (power - a.missed - a.absorbed) * dt;
        if (!at_surface)
            continue;
        for (double& joule : heat.amount)
            joule *= dt;
        deposit(s.grid, elements, heat, s.nodes);
    }
}

void deposit_losses(Simulation& s, double dt) {
    if (s.loss_laws.empty())
        return;
    const SurfaceElements& elements = s.surface.elements;
    if (s.exchange) {
        std::vector<double> temperature, energy(elements.count(), 0.0);
        surface_temperatures(s.grid, elements, s.nodes, temperature);
        const double power =
            reabsorbed_power(*s.exchange, elements, temperature, s.parameters.physics.ambient, energy);
        for (double& e : energy)
            e *= dt;
        deposit(s.grid, elements, energy, s.nodes);
        s.ledger.radiated -= power * dt;
    }
    const LossEnergy lost = deposit_losses(s.grid, s.parameters.boundary, s.loss_laws, s.eos, elements, dt,
                                           s.loss_elements, s.nodes);
    s.ledger.radiated += lost.radiated;
    s.ledger.convected += lost.convected;
    s.ledger.evaporated += lost.evaporated;
}

void deposit_face_heat(Simulation& s, double dt) {
    const auto through = [](const FaceCondition& face) {
        return face.kind == FaceCondition::Kind::convection || face.kind == FaceCondition::Kind::fixed_flux;
    };
    const Boundary& boundary = s.parameters.boundary;
    if (std::none_of(boundary.begin(), boundary.end(), through))
        return;
    const std::array<double, 6> in = deposit_face_fluxes(s.grid, boundary, s.eos, dt, s.nodes);
    for (int f = 0; f < 6; ++f) {
        if (boundary[f].kind == FaceCondition::Kind::convection)
            s.ledger.convected -= in[f];
        else
            s.ledger.face_flux_in += in[f];
    }
}

} // namespace meltscope
