#include "meltscope/run/simulation.hpp"

#include "meltscope/mpm/temperature_range.hpp"
#include "meltscope/run/heat_sources.hpp"
#include "meltscope/run/possible_state.hpp"

#include "quiescence.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace meltscope {
namespace {

/// The diffusivity's largest value is looked for over temperatures rounded outwards to this, K, so that it
/// changes seldom and runs ahead of the hottest particle.
constexpr double temperature_rounding = 100.0;

/// Stable steps of the affine transfer end between 0.9 and 1.2 dx^2/alpha on a lattice; for particles
/// anywhere lambda_max <= 6 alpha/dx^2.
double explicit_limit(const Simulation& s, double alpha) {
    const double cell = s.grid.dx * s.grid.dx / alpha;
    return s.particles.lattice > 0 ? cell : cell / 3.0;
}

/// A hundredth of a kelvin below the least temperature nothing is held back, so that round-off in a plate at
/// rest is let be.
constexpr double least_temperature_slack = 0.01;

/// Of the particles, not of the nodes: conductivities are taken at the particles, and a node that hangs on
/// the edge of a ball by a thousandth of a cell's mass may be hundreds of kelvins hotter than anything that
/// conducts. Heat capacities are taken at the nodes, but a hot one's is no smaller, and of a cold one's the
/// share in lambda_max is its (dN)^2/N of at most 2 of the 6/dx^2: with three fifths of the particles'
/// capacity there the limit falls by a fifth, and the default cfl stays below it by almost a half.
void find_extreme_temperatures(Simulation& s) {
    const TemperatureRange range = particle_temperature_range(s.grid, s.particles, s.nodes);
    require_possible(s, {range.finite, range.coldest, range.hottest});
    s.peak_temperature = range.hottest;
    s.coldest_temperature = range.coldest;
    if (!s.quiescence.bricks.awake.empty()) {
        s.peak_temperature =
            std::max(s.peak_temperature, up_to_whole_kelvin(s.quiescence.bricks.hottest_asleep));
        s.coldest_temperature =
            std::min(s.coldest_temperature, down_to_whole_kelvin(s.quiescence.bricks.coldest_asleep));
    }
}

double max_diffusivity(const Simulation& s) {
    const double coldest =
        std::max(0.0, std::floor(s.coldest_temperature / temperature_rounding) * temperature_rounding);
    // Under a laser the plate will soon melt: the first step must not be one for a cold plate.
    double expected = s.peak_temperature;
    for (const Laser& laser : s.parameters.lasers) {
        double power = 0.0;
        beam_now(laser, s.time, power);
        for (const EquationOfState& eos : s.eos)
            expected = power > 0.0 ? std::max(expected, eos.liquidus) : expected;
    }
    const double hottest = (std::ceil(expected / temperature_rounding) + 1.0) * temperature_rounding;
    double alpha = 0.0;
    for (const EquationOfState& eos : s.eos)
        alpha = std::max(alpha, max_diffusivity(eos, coldest, hottest));
    return alpha / s.least_packing;
}

StepOptions step_options(const Simulation& s, double dt) {
    const PhysicsOptions& physics = s.parameters.physics;
    StepOptions options;
    options.affine = physics.affine_transfer;
    options.energy_gradient = physics.diffuse_energy;
    if (physics.blend_time)
        options.blend = std::min(1.0, dt / *physics.blend_time);
    else if (physics.affine_transfer)
        options.blend =
            std::min(1.0, dt * std::min(max_diffusivity(s), s.powder_diffusivity) / (s.grid.dx * s.grid.dx));
    for (const EquationOfState& eos : s.eos)
        options.least_energy.push_back(
            eos.energy(std::max(0.0, s.least_temperature - least_temperature_slack)));
    return options;
}

/// Lowers the least temperature to what the faces and the surroundings can bring about.
void look_at_surroundings(Simulation& s) {
    for (const FaceCondition& face : s.parameters.boundary) {
        using Kind = FaceCondition::Kind;
        if (face.kind == Kind::fixed_temperature || face.kind == Kind::convection)
            s.least_temperature = std::min(s.least_temperature, face.temperature);
        else if (face.kind == Kind::fixed_flux && face.flux < 0.0)
            s.least_temperature = 0.0;
    }
    if (!s.loss_laws.empty())
        s.least_temperature = std::min(s.least_temperature, s.parameters.physics.ambient);
}

/// Lowers the least temperature to that of the coldest of these particles.
void look_at_coldest(Simulation& s, const ParticleList& particles) {
    for (std::int64_t q = 0; q < particles.size(); ++q)
        s.least_temperature = std::min(
            s.least_temperature, s.eos[particles.material[q]].temperature(particles.specific_energy[q]));
}

LossOptions loss_options(const PhysicsOptions& physics) {
    return {physics.radiation, physics.evaporation, physics.convection, physics.ambient};
}

/// `nodes` count all particles, whether they are awake or not.
void make_losses(Simulation& s, const Nodes& nodes) {
    const PhysicsOptions& physics = s.parameters.physics;
    s.loss_laws.clear();
    s.exchange.reset();
    if (!loss_options(physics).any())
        return;
    s.loss_laws = make_loss_laws(s.parameters.materials, loss_options(physics));
    s.loss_elements = make_loss_elements(s.grid, s.parameters.boundary, s.surface.elements, nodes);
    if (physics.reabsorption)
        s.exchange = make_radiative_exchange(s.grid, s.surface, s.particles, s.parameters.materials, {});
}

/// What all homogenised powder has in common, molten since or not: the least packing, since powder that has
/// melted keeps its mass and conducts as bulk, so that its diffusivity is larger by 1/packing; and the
/// largest diffusivity before it melts, of the material in which that is least.
void look_at_powder(Simulation& s) {
    s.least_packing = 1.0;
    s.powder_diffusivity = std::numeric_limits<double>::infinity();
    if (s.particles.powder.empty())
        return;
    std::vector<double> packing(s.eos.size(), 1.0);
    for (std::int64_t q = 0; q < s.particles.count(); ++q) {
        const std::int64_t at = s.particles.layout.place[q];
        double& least = packing[s.particles.material[q]];
        least = std::min(least, s.particles.mass[at] /
                                    (s.particles.volume[at] * s.eos[s.particles.material[q]].density));
    }
    for (std::size_t a = 0; a < s.eos.size(); ++a) {
        s.least_packing = std::min(s.least_packing, packing[a]);
        if (packing[a] < 1.0 - 1e-9)
            s.powder_diffusivity =
                std::min(s.powder_diffusivity, max_powder_diffusivity(s.eos[a]) / packing[a]);
    }
}

/// Makes what follows from the particles' places: node masses, free surface, light maps. All particles are
/// awake then.
void make_derived(Simulation& s) {
    const auto begin = std::chrono::steady_clock::now();
    look_at_powder(s);
    s.particles.awake = all_groups(s.particles.layout);
    s.quiescence = {};
    s.nodes = make_nodes(s.grid, s.particles, int(s.eos.size()), s.parameters.boundary);
    s.surface = find_free_surface(s.grid, s.particles, s.nodes, s.parameters.level_set,
                                  s.parameters.physics.deposit_at_surface);
    s.light_maps.clear();
    for (const Laser& laser : s.parameters.lasers)
        s.light_maps.push_back(make_light_map(s.grid, s.surface, laser.direction));
    make_losses(s, s.nodes);
    look_at_surroundings(s);
    s.seconds_in_level_set += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void find_node_state(Simulation& s) {
    favre_mean(s.grid, s.eos, s.parameters.boundary, s.nodes);
    find_extreme_temperatures(s);
}

/// Makes everything anew from the particles and the mass-energies as far as they were awake.
void make_derived_again(Simulation& s, Field mass_energy, std::vector<char> awake) {
    make_derived(s);
    s.nodes.mass_energy = std::move(mass_energy);
    if (!awake.empty()) {
        // Nodes that only sleeping particles reach get their temperature for good.
        favre_mean(s.grid, s.eos, s.parameters.boundary, s.nodes);
        go_on_asleep(s, std::move(awake));
    }
    find_node_state(s);
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
    s.least_temperature = std::numeric_limits<double>::infinity();
    look_at_coldest(s, particles);
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
    particles_to_grid(s.grid, s.particles, nullptr, s.nodes);  // 3
    favre_mean(s.grid, s.eos, s.parameters.boundary, s.nodes); // 4
    fall_asleep(s);
    find_extreme_temperatures(s);
    s.ledger.stored_at_start = s.ledger.stored = total_energy(s.particles);
    return s;
}

Simulation resume_simulation(RunParameters parameters, const Grid& grid, ParticleList particles, int lattice,
                             double time, std::int64_t step, double dt, const Ledger& ledger,
                             const Field& mass_energy, double least_temperature, std::vector<char> awake) {
    Simulation s = set_up(std::move(parameters), grid, std::move(particles), lattice);
    if (std::int64_t(mass_energy.size()) != grid.size)
        throw std::invalid_argument("the saved mass-energy does not fit the grid");
    if (!awake.empty() && std::int64_t(awake.size()) != brick_counts(grid).prod())
        throw std::invalid_argument("the saved bricks that are awake do not fit the grid");
    s.nodes.mass_energy = mass_energy;
    s.least_temperature = least_temperature;
    look_at_surroundings(s);
    if (!awake.empty()) {
        favre_mean(s.grid, s.eos, s.parameters.boundary, s.nodes);
        go_on_asleep(s, std::move(awake));
    }
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
    wake_for_step(s, dt);

    // e^n -> e^{n+1}. Steps 1 and 2 stand while the particles do; 3 and 4 were done at the end of the last
    // step.
    diffuse(s.grid, s.particles, s.eos, options, dt, s.nodes); // 5
    deposit_laser_heat(s, dt);                                 // 5
    deposit_losses(s, dt);                                     // 5
    deposit_face_heat(s, dt);                                  // 5
    s.ledger.conducted_out -=
        update_grid_energy(s.grid, s.particles, s.eos, s.parameters.boundary, options, dt, s.nodes); // 6
    grid_to_particles_to_grid(s.grid, options, s.particles, s.nodes); // 7, and 3 of the next step
    s.time = steps_left == 1.0 ? target : s.time + dt;
    s.dt = dt;
    ++s.step;
    find_node_state(s); // 4 of the next step
}

void update_geometry(Simulation& s) {
    make_derived_again(s, s.nodes.mass_energy, s.quiescence.bricks.awake);
}

void update_losses(Simulation& s) {
    make_loss_laws(s.parameters.materials,
                   loss_options(s.parameters.physics)); // throws before anything changes
    s.quiescence.looked_with = -1.0;
    if (s.quiescence.bricks.awake.empty()) {
        make_losses(s, s.nodes);
    } else {
        const GroupRuns awake = std::exchange(s.particles.awake, all_groups(s.particles.layout));
        make_losses(s, make_nodes(s.grid, s.particles, int(s.eos.size()), s.parameters.boundary));
        s.particles.awake = awake;
        find_elements_awake(s);
    }
    look_at_surroundings(s);
}

void update_boundary(Simulation& s) {
    // e(T_i), not e_i: at faces of fixed temperature it is T_i that continues the field beyond them.
    std::vector<Field> energy(s.eos.size(), Field(s.grid.size, 0.0));
    for (std::size_t a = 0; a < energy.size(); ++a)
        for (std::int64_t i = 0; i < s.grid.size; ++i)
            energy[a][i] = s.eos[a].energy(s.nodes.temperature[i]);
    std::vector<char> awake = s.quiescence.bricks.awake;
    make_derived(s);
    particles_to_grid(s.grid, s.particles, &energy, s.nodes);
    if (!awake.empty()) {
        favre_mean(s.grid, s.eos, s.parameters.boundary, s.nodes);
        go_on_asleep(s, std::move(awake));
        Field of_awake(s.grid.size, 0.0);
        add_node_energy(s.grid, s.particles, s.particles.awake, &energy, of_awake);
        fold_ghosts(s.grid, s.parameters.boundary, AtFixedFaces::leave, of_awake);
        for (std::int64_t i = 0; i < s.grid.size; ++i)
            if (s.nodes.mass[i] > 0.0)
                s.nodes.mass_energy[i] = of_awake[i];
    }
    find_node_state(s);
}

void add_particles(Simulation& s, const ParticleList& more) {
    // Where they come, all are awake: the nodes there hold the energy of all.
    std::vector<char> awake = wake_around(s, more.position);
    Field mass_energy = s.nodes.mass_energy;
    // What the new ones bring to the nodes is added to what the old ones have gathered there.
    const Particles added = make_particles(s.grid, more, s.particles.lattice);
    Nodes of_added = make_nodes(s.grid, added, int(s.eos.size()), s.parameters.boundary);
    particles_to_grid(s.grid, added, nullptr, of_added);
    fold_ghosts(s.grid, s.parameters.boundary, AtFixedFaces::leave, of_added.mass_energy);
    for (std::int64_t i = 0; i < s.grid.size; ++i)
        mass_energy[i] += of_added.mass_energy[i];
    s.ledger.added += total_energy(added);
    look_at_coldest(s, more);

    ParticleList all = list_particles(s.particles);
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(all.position, more.position);
    append(all.mass, more.mass);
    append(all.volume, more.volume);
    append(all.specific_energy, more.specific_energy);
    append(all.id, more.id);
    append(all.material, more.material);
    if (!all.powder.empty() || !more.powder.empty()) {
        all.powder.resize(s.particles.count(), 0);
        append(all.powder, more.powder);
        all.powder.resize(all.id.size(), 0);
    }
    s.particles = make_particles(s.grid, std::move(all), s.particles.lattice);
    make_derived_again(s, std::move(mass_energy), std::move(awake));
}

const Field& node_masses(const Simulation& s) {
    return s.quiescence.bricks.awake.empty() ? s.nodes.mass : s.quiescence.mass_of_all;
}

void balance(Simulation& s) {
    s.ledger.stored = total_energy(s.particles);
}

double energy_spread(const Simulation& s) {
    const Field interpolated = particle_temperatures(s.grid, s.particles, s.nodes);
    const std::vector<LaneGroup>& groups = s.particles.layout.groups;
    double most = 0.0;
#pragma omp parallel for schedule(static) reduction(max : most)
    for (std::size_t g = 0; g < groups.size(); ++g) {
        Lanes most_here(0.0);
        for (std::int64_t slot = groups[g].first_slot; slot < groups[g].first_slot + groups[g].slots;
             ++slot) {
            const std::int64_t at = slot * lane_count;
            const Lanes own = s.eos[groups[g].kind].temperature(load(&s.particles.specific_energy[at]));
            const auto padding = load(&s.particles.mass[at]) == 0.0;
            most_here = max(most_here, select(padding, Lanes(0.0), abs(own - load(&interpolated[at]))));
        }
        most = std::max(most, hmax(most_here));
    }
    return most;
}

} // namespace meltscope
