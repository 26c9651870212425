// Wall time against error on a plate with an exact solution, for meltscope's settings and for plain finite
// differences. Prints CSV; plot_time_to_solution.py draws it.

#include "finite_differences.hpp"
#include "machine_probe.hpp"
#include "plate.hpp"
#include "stopwatch.hpp"

#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/scenario/setup.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <cstdlib>

namespace meltscope::benchmarks {
namespace {

struct Setting {
    double dx; ///< m
    int particles_per_cell;
    const char* transfer;
    double cfl;
};

/// What one run took; runs that are soon over are made three times.
struct Outcome {
    double seconds; ///< of the time loop alone, median
    double error_percent;
    std::int64_t steps;
};

Scenario plate_scenario(const Setting& setting) {
    const std::string text = fmt::format(
        R"([material.constant]
density = {density}
solidus = 5000.0
liquidus = 5500.0
latent_heat = 0.0
conductivity = {{solid = [{conductivity}], liquid = [{conductivity}]}}
heat_capacity = {{solid = [{heat_capacity}], liquid = [{heat_capacity}]}}
[domain]
min = [0, {side}, {bottom}]
max = [{length}, {other_side}, {head}]
cell_size = {dx}
particles_per_cell = {particles_per_cell}
[[body]]
shape = "box"
material = "constant"
min = [0, {side}, {bottom}]
max = [{length}, {other_side}, 0]
[[laser]]
power = {power}
absorptivity = 1.0
spot_radius = {spot_radius}
path = [{{move = [{start}, 0, 0]}}, {{to = [{stop}, 0, 0], speed = {speed}}}]
[physics]
transfer = "{transfer}"
[time]
end = {end}
cfl = {cfl}
)",
        fmt::arg("density", Plate::density), fmt::arg("conductivity", Plate::conductivity),
        fmt::arg("heat_capacity", Plate::heat_capacity), fmt::arg("side", -0.5 * Plate::width),
        fmt::arg("other_side", 0.5 * Plate::width), fmt::arg("bottom", -PlateCells(setting.dx).depth()),
        fmt::arg("length", Plate::length), fmt::arg("head", 3.0 * setting.dx), fmt::arg("dx", setting.dx),
        fmt::arg("particles_per_cell", setting.particles_per_cell), fmt::arg("power", Plate::absorbed_power),
        fmt::arg("spot_radius", 0.5 * Plate::d4sigma), fmt::arg("start", Plate::start),
        fmt::arg("stop", Plate::start + Plate::track), fmt::arg("speed", Plate::speed),
        fmt::arg("transfer", setting.transfer), fmt::arg("end", Plate::end_time),
        fmt::arg("cfl", setting.cfl));
    return read_scenario_text(text, {}, "plate");
}

template <class Run>
Outcome median_outcome(const Run& run) {
    Outcome outcome = run();
    std::vector<double> seconds{outcome.seconds};
    for (int n = 1; n < 3 && outcome.seconds < 3.0; ++n)
        seconds.push_back(run().seconds);
    outcome.seconds = median(seconds);
    return outcome;
}

Outcome run_particles(const Setting& setting, const ExactRise& exact, std::int64_t& particles) {
    const Scenario scenario = plate_scenario(setting);
    Simulation s = make_simulation(run_parameters(scenario), scenario_grid(scenario), fill_scenario(scenario),
                                   lattice_of(scenario));
    particles = s.particles.count();
    const double start = s.peak_temperature;
    const Stopwatch watch;
    while (s.time < s.parameters.time.end)
        advance(s, s.parameters.time.end);
    Outcome outcome;
    outcome.seconds = watch.seconds();
    outcome.steps = s.step;
    outcome.error_percent = exact.error_percent([&](std::int64_t i, std::int64_t j, std::int64_t k) {
        return s.nodes.temperature[s.grid.index(i, j, k)] - start;
    });
    return outcome;
}

Outcome run_differences(const PlateCells& cells, const ExactRise& exact) {
    FiniteDifferences differences(cells);
    const Stopwatch watch;
    differences.run();
    const double seconds = watch.seconds();
    return {seconds, exact.error_percent([&](std::int64_t i, std::int64_t j, std::int64_t k) {
                return differences.rise(i, j, k);
            }),
            differences.steps()};
}

/// The runs of one cell size that have at most `limit` particle-steps.
void compare(double dx, std::int64_t limit) {
    const PlateCells cells(dx);
    const ExactRise exact(cells);
    const auto print = [&](const char* method, const Setting& s, std::int64_t unknowns, const Outcome& o) {
        fmt::print("{},{:.4g},{},{},{},{},{},{:.4g},{:.4g}\n", method, 1e6 * s.dx, s.particles_per_cell,
                   s.transfer, s.cfl, unknowns, o.steps, o.seconds, o.error_percent);
        std::fflush(stdout);
    };
    print("differences", {dx, 0, "none", 1.0 / 6.0}, exact.nx * exact.ny * exact.nz,
          median_outcome([&] { return run_differences(cells, exact); }));
    const double plate = double(cells.x) * double(cells.y) * double(cells.z); // cells
    const double cell_times = Plate::end_time * Plate::diffusivity / (dx * dx);
    for (const int per_cell : {1, 8})
        for (const char* transfer : {"affine", "flip"})
            for (const double cfl : {0.25, 0.5, 0.8}) {
                if (plate * per_cell * cell_times / cfl > double(limit))
                    continue;
                const Setting setting{dx, per_cell, transfer, cfl};
                std::int64_t particles = 0;
                const Outcome outcome =
                    median_outcome([&] { return run_particles(setting, exact, particles); });
                print("particles", setting, particles, outcome);
            }
}

} // namespace
} // namespace meltscope::benchmarks

int main(int count, char** words) {
    using namespace meltscope;
    if (count > 2) {
        fmt::print(stderr, "usage: {} [PARTICLE-STEPS OF A RUN AT MOST]\n", words[0]);
        return 2;
    }
    const std::int64_t limit = count > 1 ? std::int64_t(std::atof(words[1])) : std::int64_t(1) << 60;
    fmt::print("# threads {}, FMA probe {:.1f} GFLOP/s, STREAM triad {:.1f} GB/s\n", omp_get_max_threads(),
               probe_fma_gflops(), probe_triad_gb_per_s());
    fmt::print("method,cell_um,particles_per_cell,transfer,cfl,unknowns,steps,seconds,error_percent\n");
    for (const double dx : {25e-6, 20e-6, 12.5e-6, 10e-6, 6.25e-6, 5e-6})
        benchmarks::compare(dx, limit);
}
