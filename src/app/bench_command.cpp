#include "bench_insitu.hpp"
#include "commands.hpp"
#include "exit_codes.hpp"
#include "machine_probe.hpp"
#include "run_setup.hpp"
#include "stopwatch.hpp"
#include "text.hpp"

#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/scenario/setup.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <omp.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

namespace meltscope {
namespace {

struct BenchRequest {
    std::int64_t particles = 2'000'000;
    int threads = 0;
    std::vector<std::string> overrides;
    bool json = false;
    bool in_situ = false;
};

constexpr int repetitions = 5;
constexpr int steps_in_repetition = 6;

/// A block twice as long as wide and deep with the wanted number of particles under a laser, all else by
/// default. The material is IN625 with the figures of scenarios/materials/in625.toml.
Scenario block_scenario(const BenchRequest& request) {
    const int cells = std::max(8, int(std::lround(std::cbrt(double(request.particles) / 2.0) / 2.0)) * 2);
    const double dx = 1e-5, length = cells * dx, width = cells / 2 * dx, head = 3 * dx;
    const std::string text =
        fmt::format(R"(
title = "bench"
[material.in625]
density = 7569.92
solidus = 1410.0
liquidus = 1620.0
latent_heat = 2.1754e5
conductivity = {{solid = [8.275, 0.01472], liquid = [4.889, 0.014743]}}
heat_capacity = {{solid = [579.28], liquid = [750.65]}}
emissivity = 0.4
[domain]
min = [0, 0, {bottom}]
max = [{length}, {width}, {head}]
cell_size = {dx}
[[body]]
shape = "box"
material = "in625"
min = [0, 0, {bottom}]
max = [{length}, {width}, 0]
[[laser]]
power = 180.0
absorptivity = 0.4
spot_radius = 5e-5
path = [{{move = [{start}, {middle}, 0]}}, {{to = [{stop}, {middle}, 0], speed = 0.8}}]
[physics]
radiation = true
[time]
end = 1.0
)",
                    fmt::arg("bottom", -width), fmt::arg("length", length), fmt::arg("width", width),
                    fmt::arg("head", head), fmt::arg("dx", dx), fmt::arg("start", 0.25 * length),
                    fmt::arg("stop", 0.75 * length), fmt::arg("middle", 0.5 * width));
    return read_scenario_text(text, request.overrides, "bench");
}

/// Seconds of a step by phase; what is not one of the first four is the heat of lasers and surfaces, the
/// choice of the step and the search for extremes.
struct PhaseSeconds {
    double favre = 0.0, diffuse = 0.0, update = 0.0, g2p = 0.0;

    double sum() const { return favre + diffuse + update + g2p; }
};

/// The parts of a step one by one, as advance() calls them.
PhaseSeconds time_phases(Simulation& s) {
    StepOptions options;
    options.affine = s.parameters.physics.affine_transfer;
    options.energy_gradient = s.parameters.physics.diffuse_energy;
    options.blend = options.affine ? 0.4 : 0.0;
    PhaseSeconds seconds;
    const auto timed = [](double& account, const auto& work) {
        const Stopwatch watch;
        work();
        account = watch.seconds();
    };
    timed(seconds.diffuse, [&] { diffuse(s.grid, s.particles, s.eos, options, s.dt, s.nodes); });
    timed(seconds.update, [&] {
        update_grid_energy(s.grid, s.particles, s.eos, s.parameters.boundary, options, s.dt, s.nodes);
    });
    timed(seconds.g2p, [&] { grid_to_particles_to_grid(s.grid, options, s.particles, s.nodes); });
    timed(seconds.favre, [&] { favre_mean(s.grid, s.eos, s.parameters.boundary, s.nodes); });
    return seconds;
}

struct BenchResult {
    std::int64_t particles = 0;
    int threads = 0;
    double step_seconds = 0.0; ///< of a whole step
    PhaseSeconds phases;       ///< of a step
    double fma_gflops = 0.0, triad_gb_per_s = 0.0;
    std::optional<InSituCost> in_situ;

    double particle_steps_per_s() const { return double(particles) / step_seconds; }
    double other_seconds() const { return std::max(0.0, step_seconds - phases.sum()); }

    /// What the probes allow, particle-steps/s: a particle-step needs about 800 operations and 128 bytes.
    double limit() const { return std::min(fma_gflops * 1e9 / 800.0, triad_gb_per_s * 1e9 / 128.0); }
};

BenchResult measure(const BenchRequest& request) {
    InputOfRun input;
    input.scenario = block_scenario(request);
    require_memory_for(input.scenario);
    PreparedRun prepared = prepare_run(std::move(input));
    Simulation& simulation = prepared.run.simulation;

    BenchResult result;
    result.particles = simulation.particles.count();
    result.threads = omp_get_max_threads();
    const auto step = [&] { advance(simulation, simulation.parameters.time.end); };
    step(); // touches all memory once
    std::vector<double> whole;
    std::array<std::vector<double>, 4> parts;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        const Stopwatch watch;
        for (int n = 0; n < steps_in_repetition; ++n)
            step();
        whole.push_back(watch.seconds() / steps_in_repetition);
        const PhaseSeconds phases = time_phases(simulation);
        parts[0].push_back(phases.favre);
        parts[1].push_back(phases.diffuse);
        parts[2].push_back(phases.update);
        parts[3].push_back(phases.g2p);
    }
    result.step_seconds = median(whole);
    result.phases = {median(parts[0]), median(parts[1]), median(parts[2]), median(parts[3])};
    result.fma_gflops = probe_fma_gflops();
    result.triad_gb_per_s = probe_triad_gb_per_s();
    if (request.in_situ)
        result.in_situ = measure_insitu_cost(simulation);
    return result;
}

std::string as_json(const BenchResult& result) {
    nlohmann::ordered_json json = {{"particle_steps_per_s", result.particle_steps_per_s()},
                                   {"fma_gflops", result.fma_gflops},
                                   {"triad_gb_per_s", result.triad_gb_per_s},
                                   {"share_of_limit", result.particle_steps_per_s() / result.limit()},
                                   {"particles", result.particles},
                                   {"threads", result.threads},
                                   {"simd_width", lane_count},
                                   {"seconds",
                                    {{"step", result.step_seconds},
                                     {"favre", result.phases.favre},
                                     {"diffuse", result.phases.diffuse},
                                     {"deposit", result.other_seconds()},
                                     {"update", result.phases.update},
                                     {"g2p", result.phases.g2p}}}};
    if (const auto& cost = result.in_situ)
        json["insitu"] = {{"steps_between_outputs", cost->steps},
                          {"seconds_without", cost->without_seconds},
                          {"seconds_with", cost->with_seconds},
                          {"ratio", cost->ratio()},
                          {"frames", cost->frames},
                          {"files", cost->files},
                          {"seconds_of_a_frame", cost->render_seconds},
                          {"seconds_of_files", cost->file_seconds}};
    return json.dump(2) + "\n";
}

std::string as_text(const BenchResult& result) {
    std::string text = fmt::format("{} particles, {} thread{}, SIMD width {}\n", result.particles,
                                   result.threads, result.threads == 1 ? "" : "s", lane_count);
    const auto line = [&](const char* name, const std::string& value) {
        text += fmt::format("  {:<26} {}\n", name, value);
    };
    line("speed", fmt::format("{:.1f} M particle-steps/s", 1e-6 * result.particle_steps_per_s()));
    line("FMA probe", fmt::format("{:.1f} GFLOP/s", result.fma_gflops));
    line("STREAM triad", fmt::format("{:.1f} GB/s", result.triad_gb_per_s));
    line("share of what these allow",
         fmt::format("{:.0f} % of {:.0f} M particle-steps/s (800 operations, 128 bytes each)",
                     100.0 * result.particle_steps_per_s() / result.limit(), 1e-6 * result.limit()));
    text += "Milliseconds of a step\n";
    const auto phase = [&](const char* name, double seconds) {
        line(name, fmt::format("{:.2f}", 1e3 * seconds));
    };
    phase("favre mean", result.phases.favre);
    phase("diffuse", result.phases.diffuse);
    phase("deposit and all else", result.other_seconds());
    phase("update", result.phases.update);
    phase("g2p with the next p2g", result.phases.g2p);
    phase("together", result.step_seconds);
    if (const auto& cost = result.in_situ) {
        text += fmt::format("Seconds of {} steps, medians of turns\n", cost->steps);
        line("without output", fmt::format("{:.3f}", cost->without_seconds));
        line("with pictures and files", fmt::format("{:.3f}", cost->with_seconds));
        line("ratio", fmt::format("{:.3f}", cost->ratio()));
        line("one overview picture", fmt::format("{:.3f}", cost->render_seconds));
        line("one output's data files", fmt::format("{:.3f}", cost->file_seconds));
    }
    return text;
}

int execute(const BenchRequest& request) {
    if (request.threads > 0)
        omp_set_num_threads(request.threads);
    const BenchResult result = measure(request);
    std::fputs((request.json ? as_json(result) : as_text(result)).c_str(), stdout);
    return exit_code::done;
}

} // namespace

void add_bench(CLI::App& program, Action& chosen) {
    auto request = std::make_shared<BenchRequest>();
    CLI::App* bench = program.add_subcommand(
        "bench", "Measure the speed of the solver on this machine, and what the machine allows");
    bench->add_option("--particles", request->particles, "Particles of the block, about; default 2000000")
        ->type_name("N")
        ->check(CLI::Range(std::int64_t(1000), std::int64_t(4'000'000'000)));
    bench->add_option("--threads", request->threads, "Threads; default all cores")
        ->type_name("N")
        ->check(CLI::Range(1, 4096));
    bench->add_option("--set", request->overrides, "Change a setting, e.g. physics.transfer=flip; repeatable")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all();
    bench->add_flag("--json", request->json, "Print JSON");
    bench->add_flag("--insitu", request->in_situ,
                    "Measure also what an overview picture and data files every 50 steps cost");
    bench->footer("Figures are medians of several repetitions; seconds are those of a step.\n"
                  "Example:\n  meltscope bench --particles 500000 --json");
    bench->callback([request, &chosen] { chosen = [request] { return execute(*request); }; });
}

} // namespace meltscope
