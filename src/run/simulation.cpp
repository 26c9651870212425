#include "meltscope/run/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace meltscope {
namespace {

/// The diffusivity's largest value is looked for over temperatures rounded outwards to this, K, so that it
/// changes seldom and runs ahead of the hottest node.
constexpr double temperature_rounding = 100.0;

/// Stable steps of the affine transfer end between 0.9 and 1.2 dx^2/alpha on a lattice; for particles
/// anywhere lambda_max <= 6 alpha/dx^2.
double explicit_limit(const Simulation& s, double alpha) {
    const double cell = s.grid.dx * s.grid.dx / alpha;
    return s.particles.lattice > 0 ? cell : cell / 3.0;
}

void find_extreme_temperatures(Simulation& s) {
    double hottest = 0.0, coldest = std::numeric_limits<double>::infinity();
    const Grid& grid = s.grid;
#pragma omp parallel for schedule(static) reduction(max : hottest) reduction(min : coldest)
    for (std::int64_t k = 0; k <= grid.cells[2]; ++k)
        for (std::int64_t j = 0; j <= grid.cells[1]; ++j)
            for (std::int64_t at = grid.index(0, j, k); at <= grid.index(grid.cells[0], j, k); ++at)
                if (s.nodes.mass[at] > 0.0) {
                    hottest = std::max(hottest, s.nodes.temperature[at]);
                    coldest = std::min(coldest, s.nodes.temperature[at]);
                }
    s.peak_temperature = hottest;
    s.coldest_temperature = coldest;
}

double max_diffusivity(const Simulation& s) {
    const double coldest =
        std::max(0.0, std::floor(s.coldest_temperature / temperature_rounding) * temperature_rounding);
    const double hottest =
        (std::ceil(s.peak_temperature / temperature_rounding) + 1.0) * temperature_rounding;
    double alpha = 0.0;
    for (const EquationOfState& eos : s.eos)
        alpha = std::max(alpha, max_diffusivity(eos, coldest, hottest));
    return alpha;
}

StepOptions step_options(const Simulation& s, double dt) {
    const PhysicsOptions& physics = s.parameters.physics;
    StepOptions options;
    options.affine = physics.affine_transfer;
    options.energy_gradient = physics.diffuse_energy;
    if (physics.blend_time)
        options.blend = std::min(1.0, dt / *physics.blend_time);
    else if (physics.affine_transfer)
        options.blend = std::min(1.0, dt * max_diffusivity(s) / (s.grid.dx * s.grid.dx));
    return options;
}

/// Step 5, the lasers' heat: what each surface element absorbs over the step goes to the nodes.
void deposit_laser_heat(Simulation& s, double dt) {
    const SurfaceElements& elements = s.surface.elements;
    std::vector<double> energy(elements.count(), 0.0); // W, then J
    bool any = false;
    s.absorption.assign(s.parameters.lasers.size(), {});
    for (std::size_t l = 0; l < s.parameters.lasers.size(); ++l) {
        const Laser& laser = s.parameters.lasers[l];
        double power = 0.0;
        const BeamPosition beam = beam_now(laser, s.time + 0.5 * dt, power);
        if (power <= 0.0)
            continue;
        const Absorption a = absorb(s.light_maps[l], laser, beam.position, power, elements, energy);
        s.absorption[l] = a;
        s.ledger.emitted += power * dt;
        s.ledger.absorbed += a.absorbed * dt;
        s.ledger.missed += a.missed * dt;
        s.ledger.reflected += (power - a.missed - a.absorbed) * dt;
        any = any || a.absorbed > 0.0;
    }
    if (!any)
        return;
    for (double& e : energy)
        e *= dt;
    deposit(s.grid, elements, energy, s.nodes);
}

/// Makes what follows from the particles' places: node masses, free surface, light maps.
void make_derived(Simulation& s) {
    const auto begin = std::chrono::steady_clock::now();
    s.nodes = make_nodes(s.grid, s.particles, int(s.eos.size()), s.parameters.boundary);
    s.surface = find_free_surface(s.grid, s.particles, s.nodes, s.parameters.level_set,
                                  s.parameters.physics.deposit_at_surface);
    s.light_maps.clear();
    for (const Laser& laser : s.parameters.lasers)
        s.light_maps.push_back(make_light_map(s.grid, s.surface, laser.direction));
    s.seconds_in_level_set += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void find_node_state(Simulation& s) {
    favre_mean(s.grid, s.eos, s.parameters.boundary, s.nodes);
    find_extreme_temperatures(s);
}

Simulation set_up(RunParameters parameters, const Grid& grid, ParticleList particles, int lattice) {
    if (particles.size() == 0)
        throw std::invalid_argument("there is not one particle: no body holds a lattice point of the domain");
    if (parameters.physics.diffuse_energy && parameters.materials.size() > 1)
        throw std::invalid_argument("the energy form of the diffusion holds for one material only");
    Simulation s;
    s.parameters = std::move(parameters);
    s.grid = grid;
    for (const Material& material : s.parameters.materials)
        s.eos.push_back(make_equation_of_state(material));
    s.particles = make_particles(grid, std::move(particles), lattice);
    make_derived(s);
    return s;
}

} // namespace

BeamPosition beam_now(const Laser& laser, double time, double& power) {
    const BeamPosition beam = beam_at(laser.path, time);
    power = laser.on && beam.on ? beam.power.value_or(laser.power) : 0.0;
    return beam;
}

Simulation make_simulation(RunParameters parameters, const Grid& grid, ParticleList particles, int lattice) {
    Simulation s = set_up(std::move(parameters), grid, std::move(particles), lattice);
    particles_to_grid(s.grid, s.particles, nullptr, s.nodes); // 3
    find_node_state(s);                                       // 4
    s.ledger.stored_at_start = s.ledger.stored = total_energy(s.particles);
    return s;
}

Simulation resume_simulation(RunParameters parameters, const Grid& grid, ParticleList particles, int lattice,
                             double time, std::int64_t step, double dt, const Ledger& ledger,
                             const Field& mass_energy) {
    Simulation s = set_up(std::move(parameters), grid, std::move(particles), lattice);
    if (std::int64_t(mass_energy.size()) != grid.size)
        throw std::invalid_argument("the saved mass-energy does not fit the grid");
    s.nodes.mass_energy = mass_energy;
    find_node_state(s);
    s.time = time;
    s.step = step;
    s.dt = dt;
    s.ledger = ledger;
    return s;
}

double largest_step(const Simulation& s, StepLimit& limit) {
    limit = StepLimit::diffusion;
    double dt = s.parameters.time.cfl * explicit_limit(s, max_diffusivity(s));
    for (const Laser& laser : s.parameters.lasers) {
        double power = 0.0;
        const BeamPosition beam = beam_now(laser, s.time, power);
        if (power > 0.0 && beam.speed * dt > 0.5 * laser.spot_radius) {
            dt = 0.5 * laser.spot_radius / beam.speed;
            limit = StepLimit::beam;
        }
    }
    if (s.parameters.time.max_step && *s.parameters.time.max_step < dt) {
        dt = *s.parameters.time.max_step;
        limit = StepLimit::max_step;
    }
    return dt;
}

void advance(Simulation& s, double target) {
    if (!(target > s.time))
        throw std::invalid_argument(fmt::format("a step from {} s cannot lead to {} s", s.time, target));
    for (const Laser& laser : s.parameters.lasers)
        if (const auto corner = next_corner_time(laser.path, s.time); corner && *corner < target)
            target = *corner;
    const double largest = largest_step(s, s.limit);
    // Equal steps to the target rather than a short last one.
    const double steps_left = std::max(1.0, std::ceil((target - s.time) / largest * (1.0 - 1e-12)));
    const double dt = (target - s.time) / steps_left;
    if (steps_left == 1.0)
        s.limit = StepLimit::landing;
    const StepOptions options = step_options(s, dt);

    // e^n -> e^{n+1}. Steps 1 and 2 stand while the particles do; 3 and 4 were done at the end of the last
    // step.
    diffuse(s.grid, s.particles, s.eos, options, dt, s.nodes); // 5
    deposit_laser_heat(s, dt);                                 // 5
    s.ledger.conducted_out -=
        update_grid_energy(s.grid, s.particles, s.eos, s.parameters.boundary, options, dt, s.nodes); // 6
    grid_to_particles_to_grid(s.grid, options, s.particles, s.nodes); // 7, and 3 of the next step
    find_node_state(s);                                               // 4 of the next step

    s.time = steps_left == 1.0 ? target : s.time + dt;
    s.dt = dt;
    ++s.step;
    if (!std::isfinite(s.peak_temperature) || !std::isfinite(s.coldest_temperature))
        throw std::runtime_error(
            fmt::format("step {} at t = {} s gave a temperature that is not a number", s.step, s.time));
}

void update_geometry(Simulation& s) {
    const Field mass_energy = s.nodes.mass_energy;
    make_derived(s);
    s.nodes.mass_energy = mass_energy;
    find_node_state(s);
}

void update_boundary(Simulation& s) {
    const std::vector<Field> energy = s.nodes.energy;
    make_derived(s);
    particles_to_grid(s.grid, s.particles, &energy, s.nodes);
    find_node_state(s);
}

void add_particles(Simulation& s, const ParticleList& more) {
    Field mass_energy = s.nodes.mass_energy;
    // What the new ones bring to the nodes is added to what the old ones have gathered there.
    const Particles added = make_particles(s.grid, more, s.particles.lattice);
    Nodes of_added = make_nodes(s.grid, added, int(s.eos.size()), s.parameters.boundary);
    particles_to_grid(s.grid, added, nullptr, of_added);
    fold_ghosts(s.grid, s.parameters.boundary, AtFixedFaces::leave, of_added.mass_energy);
    for (std::int64_t i = 0; i < s.grid.size; ++i)
        mass_energy[i] += of_added.mass_energy[i];
    s.ledger.added += total_energy(added);

    ParticleList all = list_particles(s.particles);
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(all.position, more.position);
    append(all.mass, more.mass);
    append(all.volume, more.volume);
    append(all.specific_energy, more.specific_energy);
    append(all.id, more.id);
    append(all.material, more.material);
    s.particles = make_particles(s.grid, std::move(all), s.particles.lattice);
    make_derived(s);
    s.nodes.mass_energy = std::move(mass_energy);
    find_node_state(s);
}

void balance(Simulation& s) {
    s.ledger.stored = total_energy(s.particles);
}

double energy_spread(const Simulation& s) {
    const Field interpolated = particle_temperatures(s.grid, s.particles, s.nodes);
    double most = 0.0;
    const std::int64_t count = s.particles.count();
#pragma omp parallel for schedule(static) reduction(max : most)
    for (std::int64_t q = 0; q < count; ++q) {
        const std::int64_t at = s.particles.layout.place[q];
        const double own = s.eos[s.particles.material[q]].temperature(s.particles.specific_energy[at]);
        most = std::max(most, std::abs(own - interpolated[at]));
    }
    return most;
}

} // namespace meltscope
