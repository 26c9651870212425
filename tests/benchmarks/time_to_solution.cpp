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

#include <array>
#include <cstdlib>

namespace meltscope::benchmarks {
namespace {

struct Setting {
    double dx; ///< m
    int particles_per_cell;
    const char* transfer;
    double cfl;
    double quiescent_tolerance; ///< K
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
quiescent_tolerance = {quiescent_tolerance}
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
        fmt::arg("cfl", setting.cfl), fmt::arg("quiescent_tolerance", setting.quiescent_tolerance));
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

/// The temperature field at a node, K: sum_i N_i T_i / sum_i N_i over the nodes with mass around it. The
/// nodes' own values are the spline's coefficients, which the field passes by.
double field_at(const Simulation& s, std::int64_t node) {
    constexpr std::array weight{0.125, 0.75, 0.125};
    double sum = 0.0, of_weights = 0.0;
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) {
                const std::int64_t at = node + i - 1 + (j - 1) * s.grid.stride_y + (k - 1) * s.grid.stride_z;
                const double w = s.nodes.temperature[at] > 0.0 ? weight[i] * weight[j] * weight[k] : 0.0;
                sum += w * s.nodes.temperature[at];
                of_weights += w;
            }
    return sum / of_weights;
}

Outcome run_particles(const Setting& setting, const ExactRise& exact, std::int64_t& particles) {
    const Scenario scenario = plate_scenario(setting);
    Simulation s = make_simulation(run_parameters(scenario), scenario_grid(scenario), fill_scenario(scenario),
                                   lattice_of(scenario));
    particles = s.particles.count();
    const double start = s.eos[0].temperature(s.particles.specific_energy[s.particles.layout.place[0]]);
    const Stopwatch watch;
    while (s.time < s.parameters.time.end)
        advance(s, s.parameters.time.end);
    Outcome outcome;
    outcome.seconds = watch.seconds();
    outcome.steps = s.step;
    outcome.error_percent = exact.error_percent([&](std::int64_t i, std::int64_t j, std::int64_t k) {
        return field_at(s, s.grid.index(i, j, k)) - start;
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

/// All methods and settings at one cell size.
void compare(double dx) {
    const PlateCells cells(dx);
    const ExactRise exact(cells);
    const auto print = [&](const char* method, const Setting& s, std::int64_t unknowns, const Outcome& o) {
        fmt::print("{},{:.4g},{},{},{:.3g},{:g},{},{},{:.4g},{:.4g}\n", method, 1e6 * s.dx,
                   s.particles_per_cell, s.transfer, s.cfl, s.quiescent_tolerance, unknowns, o.steps,
                   o.seconds, o.error_percent);
        std::fflush(stdout);
    };
    print("differences", {dx, 0, "none", 1.0 / 6.0, 0.0}, exact.nx * exact.ny * exact.nz,
          median_outcome([&] { return run_differences(cells, exact); }));
    for (const int per_cell : {1, 8})
        for (const Setting& setting :
             {Setting{dx, per_cell, "affine", 0.35, 1e-6}, Setting{dx, per_cell, "affine", 0.5, 1e-6},
              Setting{dx, per_cell, "affine", 0.5, 0.1}, Setting{dx, per_cell, "flip", 0.5, 1e-6}}) {
            std::int64_t particles = 0;
            const Outcome outcome = median_outcome([&] { return run_particles(setting, exact, particles); });
            print("particles", setting, particles, outcome);
        }
}

} // namespace
} // namespace meltscope::benchmarks

int main(int count, char** words) {
    using namespace meltscope;
    std::vector<double> cells{20.0, 500.0 / 27.0, 15.625, 500.0 / 34.0, 12.5, 10.0};
    if (count > 1) {
        cells.clear();
        for (int n = 1; n < count; ++n)
            cells.push_back(std::atof(words[n]));
    }
    for (const double cell : cells)
        if (!(cell >= 2.0 && cell <= 50.0)) {
            fmt::print(stderr, "usage: {} [CELL SIZE IN UM, 2 TO 50]...\n", words[0]);
            return 2;
        }
    fmt::print("# threads {}, FMA probe {:.1f} GFLOP/s, STREAM triad {:.1f} GB/s\n", omp_get_max_threads(),
               probe_fma_gflops(), probe_triad_gb_per_s());
    fmt::print("method,cell_um,particles_per_cell,transfer,cfl,quiescent_tolerance_k,unknowns,steps,seconds,"
               "error_percent\n");
    for (const double cell : cells)
        benchmarks::compare(1e-6 * cell);
}
