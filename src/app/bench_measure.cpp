#include "bench_measure.hpp"

#include "machine.hpp"
#include "machine_probe.hpp"
#include "run_setup.hpp"
#include "stopwatch.hpp"

#include "meltscope/scenario/setup.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

constexpr int repetitions = 5;
constexpr int steps_in_repetition = 6;

/// Wall seconds that `work` takes.
template <class Work>
double seconds_of(const Work& work) {
    const Stopwatch watch;
    work();
    return watch.seconds();
}

template <class Array>
double bytes_of(const Array& array) {
    return double(array.capacity() * sizeof(array[0]));
}

/// Bytes of the arrays that have an entry a particle or a slot, and of those that have one a node.
void count_bytes(const Simulation& s, SetupFigures& figures) {
    const Particles& p = s.particles;
    double of_particles = bytes_of(p.position) + bytes_of(p.id) + bytes_of(p.material) +
                          bytes_of(p.layout.place) + bytes_of(p.layout.groups);
    for (const Field* field :
         {&p.offset_x, &p.offset_y, &p.offset_z, &p.mass, &p.volume, &p.specific_energy, &p.powder})
        of_particles += bytes_of(*field);
    const Nodes& n = s.nodes;
    double of_nodes = 0.0;
    for (const Field* field :
         {&n.mass, &n.inertia, &n.mass_energy, &n.temperature, &n.increment, &s.surface.phi})
        of_nodes += bytes_of(*field);
    for (const auto* fields : {&n.energy, &n.new_energy, &n.material_mass})
        for (const Field& field : *fields)
            of_nodes += bytes_of(field);
    of_nodes += bytes_of(s.loss_elements.gain);
    figures.bytes_a_particle = of_particles / double(p.count());
    figures.bytes_a_node = of_nodes / double(s.grid.node_count());
}

std::int64_t count_nodes_in_band(const Simulation& s) {
    const double far = level_set_band * s.grid.dx * (1.0 - 1e-12);
    std::int64_t count = 0;
    for (std::int64_t k = 0; k <= s.grid.cells[2]; ++k)
        for (std::int64_t j = 0; j <= s.grid.cells[1]; ++j)
            for (std::int64_t i = 0; i <= s.grid.cells[0]; ++i)
                count += std::abs(s.surface.phi[s.grid.index(i, j, k)]) < far;
    return count;
}

/// Sets the scene up as a run does, with the time of each part.
Simulation set_up(const Scenario& scenario, SetupFigures& figures) {
    const double before = forget_peak_memory();
    std::vector<Shape> shapes;
    figures.packing_seconds = seconds_of([&] { shapes = make_shapes(scenario); });
    ParticleList list;
    figures.filling_seconds = seconds_of([&] { list = fill_scenario(scenario, shapes); });
    Simulation s;
    figures.preparing_seconds = seconds_of([&] {
        s = make_simulation(run_parameters(scenario), scenario_grid(scenario), std::move(list),
                            lattice_of(scenario));
    });
    s.parameters.time.end = std::max(s.parameters.time.end, 1.0); // later than all steps of the measurement
    advance(s, s.parameters.time.end);                            // touches what is left
    figures.peak_bytes = peak_memory() - before;
    keep_freed_memory(); // as a run does from here on
    count_bytes(s, figures);
    figures.nodes_in_band = count_nodes_in_band(s);
    std::vector<double> surface, all;
    for (int n = 0; n < 7; ++n) {
        surface.push_back(seconds_of([&] {
            const Field phi = signed_distance(s.grid, s.particles, s.parameters.level_set);
            find_surface_areas(s.grid, s.particles, phi, regularized(s.grid, phi, s.parameters.level_set));
        }));
        all.push_back(seconds_of([&] {
            s.surface = find_free_surface(s.grid, s.particles, s.nodes, s.parameters.level_set,
                                          s.parameters.physics.deposit_at_surface);
        }));
    }
    figures.surface_seconds = median(surface);
    figures.elements_seconds = median(all) - median(surface);
    return s;
}

/// One form of the step and its repetitions.
struct Turns {
    bool affine = true;
    int threads = 1;
    std::vector<double> step;
    std::array<std::vector<double>, all_phases.size()> phases;
};

void take_turn(Simulation& s, Turns& turns) {
    omp_set_num_threads(turns.threads);
    s.parameters.physics.affine_transfer = turns.affine;
    advance(s, s.parameters.time.end); // caches as this form leaves them
    turns.step.push_back(seconds_of([&] {
                             for (int n = 0; n < steps_in_repetition; ++n)
                                 advance(s, s.parameters.time.end);
                         }) /
                         steps_in_repetition);
    for (std::size_t n = 0; n < all_phases.size(); ++n)
        turns.phases[n].push_back(seconds_of([&] { run_phase(s, all_phases[n]); }));
}

SpeedFigures figures_of(const Turns& turns, std::int64_t particles) {
    SpeedFigures figures;
    figures.transfer = turns.affine ? "affine" : "flip";
    figures.threads = turns.threads;
    figures.step_seconds = median(turns.step);
    figures.particle_steps_per_s = double(particles) / figures.step_seconds;
    figures.rest_seconds = figures.step_seconds;
    for (std::size_t n = 0; n < all_phases.size(); ++n) {
        figures.phases[n] = median(turns.phases[n]);
        figures.rest_seconds -= figures.phases[n];
    }
    figures.rest_seconds = std::max(0.0, figures.rest_seconds);
    return figures;
}

} // namespace

SceneFigures measure_scene(const std::string& name, const Scenario& scenario, bool both_transfers,
                           bool in_situ) {
    require_memory_for(scenario);
    SceneFigures figures;
    figures.scene = name;
    Simulation s = set_up(scenario, figures.setup);
    figures.particles = s.particles.count();
    figures.nodes = s.grid.node_count();
    figures.entries = s.particles.layout.size();

    const int threads = omp_get_max_threads();
    const bool affine = s.parameters.physics.affine_transfer;
    std::vector<Turns> all;
    for (const bool form : {affine, !affine}) {
        if (form != affine && !both_transfers)
            continue;
        all.push_back({form, threads, {}, {}});
        if (threads > 1)
            all.push_back({form, 1, {}, {}});
    }
    std::vector<double> fma, triad;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        for (Turns& turns : all)
            take_turn(s, turns);
        omp_set_num_threads(threads);
        fma.push_back(probe_fma_gflops());
        triad.push_back(probe_triad_gb_per_s());
    }
    s.parameters.physics.affine_transfer = affine;
    for (const Turns& turns : all)
        figures.speed.push_back(figures_of(turns, figures.particles));
    figures.fma_gflops = median(fma);
    figures.triad_gb_per_s = median(triad);
    if (in_situ)
        figures.in_situ = measure_insitu_cost(s);
    return figures;
}

} // namespace meltscope
