#include "block.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

// lane_width_reference.csv is a run of this block with eight lanes: its state after 20 steps, as a checkpoint
// holds it, and the particles' energies after 40. A build with any number of lanes goes on from there.

namespace meltscope {
namespace {

using namespace test;

constexpr int steps_before = 20, steps_after = 20;
constexpr double end = 1.0; // s, of a step's target: the largest step is taken
/// Of each step's sums over the particles of a node: some 50 roundings of 1e-16, over 20 steps.
constexpr double round_off = 1e-12;

const std::string reference_file = MELTSCOPE_SOURCE_DIR "/tests/unit/run/lane_width_reference.csv";

RunParameters heated_parameters() {
    RunParameters parameters = block_parameters();
    Laser laser;
    laser.name = "beam";
    laser.power = 2.0;
    laser.absorptivity = 0.5;
    laser.spot_radius = 20e-6;
    laser.path.start = Vec3(20e-6, 20e-6, 0.0);
    laser.path.segments.push_back(
        {PathSegment::Kind::line, Vec3(50e-6, 20e-6, 0.0), 0.5, 0.0, std::nullopt, true});
    parameters.lasers = {laser};
    return parameters;
}

Simulation heated_block() {
    const Grid grid = block_grid({6, 4, 4});
    return make_simulation(heated_parameters(), grid, block_particles(grid, 30e-6, 300.0), 2);
}

/// All that a restart needs, in the order of particles and nodes.
struct State {
    double time = 0.0, dt = 0.0;
    std::vector<double> energy, mass_energy, energy_at_end;
};

/// Every node with its ghosts; where they lie in a field depends on the number of lanes.
template <class Action>
void for_each_node(const Grid& grid, Action action) {
    for (std::int64_t k = -1; k <= grid.cells[2] + 1; ++k)
        for (std::int64_t j = -1; j <= grid.cells[1] + 1; ++j)
            for (std::int64_t i = -1; i <= grid.cells[0] + 1; ++i)
                action(grid.index(i, j, k));
}

State state_of(const Simulation& s) {
    State state{s.time, s.dt, list_particles(s.particles).specific_energy, {}, {}};
    for_each_node(s.grid, [&](std::int64_t at) { state.mass_energy.push_back(s.nodes.mass_energy[at]); });
    return state;
}

Simulation restarted(const State& state) {
    const Grid grid = block_grid({6, 4, 4});
    ParticleList list = block_particles(grid, 30e-6, 300.0);
    list.specific_energy = state.energy;
    Field mass_energy(grid.size, 0.0);
    std::size_t next = 0;
    for_each_node(grid, [&](std::int64_t at) { mass_energy[at] = state.mass_energy.at(next++); });
    return resume_simulation(heated_parameters(), grid, std::move(list), 2, state.time, steps_before,
                             state.dt, Ledger{}, mass_energy, 300.0);
}

State read_reference() {
    std::ifstream file(reference_file);
    State state;
    std::string kind;
    double value = 0.0;
    while (std::getline(file, kind, ',') && file >> value >> std::ws) {
        if (kind == "time")
            state.time = value;
        else if (kind == "dt")
            state.dt = value;
        else if (kind == "energy")
            state.energy.push_back(value);
        else if (kind == "mass_energy")
            state.mass_energy.push_back(value);
        else if (kind == "energy_at_end")
            state.energy_at_end.push_back(value);
    }
    return state;
}

std::vector<double> after_the_rest(Simulation s) {
    for (int n = 0; n < steps_after; ++n)
        advance(s, end);
    return list_particles(s.particles).specific_energy;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0, scale = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n) {
        largest = std::max(largest, std::abs(a[n] - b[n]));
        scale = std::max(scale, std::abs(b[n]));
    }
    return largest / scale;
}

TEST(LaneWidth, a_state_of_eight_lanes_goes_on_with_any_number_within_round_off) {
    const State reference = read_reference();
    ASSERT_GT(reference.energy.size(), 500u);
    ASSERT_EQ(reference.energy_at_end.size(), reference.energy.size());
    const auto energy = after_the_rest(restarted(reference));
    ASSERT_EQ(energy.size(), reference.energy_at_end.size());
    EXPECT_LE(largest_difference(energy, reference.energy_at_end), round_off);
}

TEST(LaneWidth, the_whole_run_is_that_of_eight_lanes_within_round_off) {
    const State reference = read_reference();
    Simulation s = heated_block();
    for (int n = 0; n < steps_before; ++n)
        advance(s, end);
    const auto energy = list_particles(s.particles).specific_energy;
    ASSERT_EQ(energy.size(), reference.energy.size()) << "of " << reference_file;
    EXPECT_LE(largest_difference(energy, reference.energy), round_off);
    EXPECT_GT(s.peak_temperature, 400.0); // it was heated
}

/// Makes the reference anew: meltscope_run_test --gtest_also_run_disabled_tests
/// --gtest_filter='*make_the_reference'.
TEST(LaneWidth, DISABLED_make_the_reference) {
    Simulation s = heated_block();
    for (int n = 0; n < steps_before; ++n)
        advance(s, end);
    std::ofstream file(reference_file);
    const auto put = [&file](const char* kind, double value) { file << fmt::format("{},{}\n", kind, value); };
    put("time", s.time);
    put("dt", s.dt);
    const State state = state_of(s);
    for (const double value : state.energy)
        put("energy", value);
    for (const double value : state.mass_energy)
        put("mass_energy", value);
    for (const double value : after_the_rest(restarted(state)))
        put("energy_at_end", value);
}

} // namespace
} // namespace meltscope
