// A small fixed case that takes every kernel through a few rounds, for count_instructions.py: a plate with
// balls on it. usage: meltscope_kernel_counts affine|flip

#include "bench_phases.hpp"
#include "bench_scenes.hpp"

#include "meltscope/scenario/setup.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <string_view>

namespace {

using namespace meltscope;

constexpr std::int64_t particles = 60'000;
constexpr int steps = 3;

Scenario plate_with_balls(const std::string& transfer) {
    Scenario scenario = bench_block(particles, {"physics.transfer=" + transfer});
    const Vec3& low = scenario.domain.min;
    const double dx = scenario.domain.cell_size;
    scenario.domain.max[2] += 7.0 * dx;
    for (const double x : {0.3, 0.5, 0.7}) {
        BodySpec ball = scenario.bodies.front();
        ball.shape = Sphere{Vec3(low[0] + x * (scenario.domain.max[0] - low[0]),
                                 0.5 * (low[1] + scenario.domain.max[1]), 4.3 * dx),
                            4.4 * dx};
        scenario.bodies.push_back(ball);
    }
    return scenario;
}

void step_through(const Scenario& scenario) {
    const std::vector<Shape> shapes = make_shapes(scenario);
    Simulation s = make_simulation(run_parameters(scenario), scenario_grid(scenario),
                                   fill_scenario(scenario, shapes), lattice_of(scenario));
    advance(s, s.parameters.time.end);
    for (int n = 0; n < steps; ++n)
        for (const StepPhase phase : all_phases)
            run_phase(s, phase);
}

} // namespace

int main(int count, char** words) {
    const std::string_view transfer = count == 2 ? words[1] : "";
    if (transfer != "affine" && transfer != "flip") {
        fmt::print(stderr, "usage: {} affine|flip\n", words[0]);
        return 2;
    }
    omp_set_num_threads(1);
    step_through(plate_with_balls(std::string(transfer)));
}
