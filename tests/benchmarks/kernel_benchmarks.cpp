// Each kernel of the solver on the scenes of `meltscope bench`. The phases of the step are timed within whole
// steps, so that they find the caches as they do in a run.

#include "bench_phases.hpp"
#include "bench_scenes.hpp"
#include "machine_probe.hpp"
#include "stopwatch.hpp"

#include "meltscope/scenario/setup.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <map>

namespace meltscope {
namespace {

constexpr std::int64_t particles_wanted = 2'000'000;

enum class Scene { block, powder };

/// A scene, set up once for all benchmarks.
struct Stage {
    Scenario scenario;
    std::vector<Shape> shapes;
    Simulation simulation;
};

Stage& stage(Scene scene) {
    static std::map<Scene, Stage> stages;
    const auto [at, is_new] = stages.try_emplace(scene);
    Stage& made = at->second;
    if (is_new) {
        made.scenario =
            scene == Scene::block ? bench_block(particles_wanted, {}) : bench_powder(particles_wanted, {});
        made.shapes = make_shapes(made.scenario);
        made.simulation =
            make_simulation(run_parameters(made.scenario), scenario_grid(made.scenario),
                            fill_scenario(made.scenario, made.shapes), lattice_of(made.scenario));
        Simulation& s = made.simulation;
        for (int n = 0; n < 3; ++n)
            advance(s, s.parameters.time.end);
    }
    return made;
}

/// Bytes that a phase cannot but move: fields of particles and of nodes, each read or written once a pass.
double least_bytes(const Simulation& s, StepPhase phase) {
    const double slots = double(s.particles.layout.size()), nodes = double(s.grid.size);
    const double elements = double(s.surface.elements.layout.size());
    const bool affine = s.parameters.physics.affine_transfer;
    const double field = sizeof(double);
    switch (phase) {
    case StepPhase::diffuse: // v; T, D twice
        return field * (slots + 3.0 * nodes);
    case StepPhase::laser: // offsets, normalization, area and heat of the elements
    case StepPhase::losses:
        return field * 6.0 * elements;
    case StepPhase::update: // m; T, q, D twice, m (undoing the lumping); e twice, e* twice, m, D, (m e)
        return field * ((affine ? slots + 5.0 * nodes : 0.0) + 8.0 * nodes);
    case StepPhase::g2p: // m, e twice; two energies, (m e) twice
        return field * (3.0 * slots + (affine ? 4.0 : 3.0) * nodes);
    case StepPhase::favre:
        break;
    }
    return field * 4.0 * nodes; // m, (m e), e, T
}

double items(const Simulation& s, StepPhase phase) {
    switch (phase) {
    case StepPhase::laser:
    case StepPhase::losses:
        return double(s.surface.elements.count());
    case StepPhase::favre:
        return double(s.grid.node_count());
    default:
        return double(s.particles.count());
    }
}

void report(benchmark::State& state, double count, double bytes) {
    const double iterations = double(state.iterations());
    state.SetItemsProcessed(std::int64_t(count * iterations));
    state.SetBytesProcessed(std::int64_t(bytes * iterations));
}

void run_phase_in_step(benchmark::State& state, Scene scene, bool affine, StepPhase phase) {
    Simulation& s = stage(scene).simulation;
    s.parameters.physics.affine_transfer = affine;
    for (auto _ : state)
        for (const StepPhase each : all_phases) {
            const Stopwatch watch;
            run_phase(s, each);
            if (each == phase)
                state.SetIterationTime(watch.seconds());
        }
    report(state, items(s, phase), least_bytes(s, phase));
}

void run_p2g(benchmark::State& state, Scene scene) {
    Simulation& s = stage(scene).simulation;
    const Field kept = s.nodes.mass_energy;
    for (auto _ : state)
        particles_to_grid(s.grid, s.particles, &s.nodes.energy, s.nodes);
    s.nodes.mass_energy = kept;
    report(state, double(s.particles.count()),
           sizeof(double) * (2.0 * double(s.particles.layout.size()) + 3.0 * double(s.grid.size)));
}

void run_level_set(benchmark::State& state, Scene scene) {
    const Simulation& s = stage(scene).simulation;
    for (auto _ : state)
        benchmark::DoNotOptimize(signed_distance(s.grid, s.particles, s.parameters.level_set));
    const double far = level_set_band * s.grid.dx * (1.0 - 1e-12);
    std::int64_t in_band = 0;
    for (std::int64_t i = 0; i < s.grid.size; ++i)
        in_band += s.nodes.mass[i] > 0.0 && std::abs(s.surface.phi[i]) < far;
    report(state, double(in_band),
           sizeof(double) * (double(s.particles.layout.size()) + double(s.grid.size)));
}

void run_free_surface(benchmark::State& state, Scene scene) {
    const Simulation& s = stage(scene).simulation;
    for (auto _ : state)
        benchmark::DoNotOptimize(
            find_free_surface(s.grid, s.particles, s.nodes, s.parameters.level_set, true));
    report(state, double(s.surface.elements.count()), 0.0);
}

void run_light_map(benchmark::State& state, Scene scene) {
    const Simulation& s = stage(scene).simulation;
    for (auto _ : state)
        benchmark::DoNotOptimize(make_light_map(s.grid, s.surface, Vec3(0, 0, -1)));
    const LightMap& map = s.light_maps.front();
    report(state, double(map.count_u * map.count_v), 0.0);
}

void run_fill(benchmark::State& state, Scene scene) {
    const Stage& on = stage(scene);
    for (auto _ : state)
        benchmark::DoNotOptimize(fill_scenario(on.scenario, on.shapes));
    report(state, double(on.simulation.particles.count()), 58.0 * double(on.simulation.particles.count()));
}

void run_layout(benchmark::State& state, Scene scene) {
    const Particles& p = stage(scene).simulation.particles;
    for (auto _ : state)
        benchmark::DoNotOptimize(
            make_lane_layout(stage(scene).simulation.grid, p.position, p.material, p.lattice));
    report(state, double(p.count()), 34.0 * double(p.count())); // position, material; place
}

void run_node_masses(benchmark::State& state, Scene scene) {
    const Simulation& s = stage(scene).simulation;
    for (auto _ : state)
        benchmark::DoNotOptimize(make_nodes(s.grid, s.particles, int(s.eos.size()), s.parameters.boundary));
    report(state, double(s.particles.count()),
           sizeof(double) * (double(s.particles.layout.size()) + 7.0 * double(s.grid.size)));
}

void add(const std::string& name, void (*run)(benchmark::State&, Scene), Scene scene,
         const char* scene_name) {
    benchmark::RegisterBenchmark((name + "/" + scene_name).c_str(), run, scene)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
}

void add_all() {
    for (const Scene scene : {Scene::block, Scene::powder}) {
        const char* scene_name = scene == Scene::block ? "block" : "powder";
        for (const bool affine : {true, false})
            for (const StepPhase phase : all_phases) {
                const bool same_in_both = phase == StepPhase::diffuse || phase == StepPhase::laser ||
                                          phase == StepPhase::losses || phase == StepPhase::favre;
                if (!affine && same_in_both)
                    continue;
                const std::string form = same_in_both ? "" : affine ? "_affine" : "_flip";
                benchmark::RegisterBenchmark((phase_name(phase) + form + "/" + scene_name).c_str(),
                                             run_phase_in_step, scene, affine, phase)
                    ->Unit(benchmark::kMillisecond)
                    ->UseManualTime()
                    ->Iterations(15);
            }
        add("p2g", run_p2g, scene, scene_name);
        add("level_set", run_level_set, scene, scene_name);
        add("free_surface", run_free_surface, scene, scene_name);
        add("light_map", run_light_map, scene, scene_name);
        add("fill", run_fill, scene, scene_name);
        add("layout", run_layout, scene, scene_name);
        add("node_masses", run_node_masses, scene, scene_name);
    }
}

} // namespace
} // namespace meltscope

int main(int count, char** words) {
    benchmark::Initialize(&count, words);
    if (benchmark::ReportUnrecognizedArguments(count, words))
        return 1;
    benchmark::AddCustomContext("FMA probe", fmt::format("{:.1f} GFLOP/s", meltscope::probe_fma_gflops()));
    benchmark::AddCustomContext("STREAM triad",
                                fmt::format("{:.1f} GB/s", meltscope::probe_triad_gb_per_s()));
    meltscope::add_all();
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
}
