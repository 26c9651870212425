#pragma once

#include "meltscope/io/run_state.hpp"

#include "../../started_run.hpp"

#include <gtest/gtest.h>

#include <string>

namespace meltscope::testing {

inline constexpr const char* tiny_scenario = R"(
title = "tiny"
[material.metal]
density = 8000
solidus = 1600
liquidus = 1700
latent_heat = 2e5
conductivity = {solid = [20], liquid = [30]}
heat_capacity = {solid = [600], liquid = [700]}
emissivity = 0.4
boiling_point = 3000
latent_heat_of_vaporization = 7e6
molar_mass = 0.0558
[domain]
min = [0, 0, 0]
max = [160e-6, 120e-6, 120e-6]
cell_size = 20e-6
particles_per_cell = 1
[[body]]
shape = "box"
material = "metal"
temperature = 300
min = [0, 0, 0]
max = [160e-6, 120e-6, 60e-6]
[[laser]]
name = "red"
power = 10
spot_radius = 30e-6
absorptivity = 0.4
path = [{move = [40e-6, 60e-6, 60e-6]}, {to = [120e-6, 60e-6, 60e-6], speed = 0.5}]
[time]
end = 200e-6
max_step = 4e-6
[output]
every = 40e-6
)";

// Read and filled once: hundreds of sessions begin so.
inline const Scenario& tiny() {
    static const Scenario scenario = read_scenario_text(tiny_scenario);
    return scenario;
}

inline Run start_tiny() {
    static const Run start = started(tiny());
    return start;
}

inline ConsoleHost tiny_host() {
    static const ConsoleHost host = host_for(tiny());
    return host;
}

inline bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// A run goes on from what a checkpoint holds.
inline Run take_up(const CheckpointData& data) {
    Run run = start_tiny();
    RunParameters parameters = run.simulation.parameters;
    apply_steering(read_steering(data.steering), parameters, run.schedule);
    run.simulation = simulation_from(data, parameters, run.simulation.grid, run.simulation.particles.lattice);
    run.journal = data.journal;
    return run;
}

inline CheckpointData kept(Run& run) {
    balance(run.simulation);
    return checkpoint_of(run, tiny_host().scenario);
}

inline void expect_equal(const CheckpointData& a, const CheckpointData& b) {
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.step, b.step);
    EXPECT_EQ(a.dt, b.dt);
    EXPECT_EQ(a.particles.position, b.particles.position);
    EXPECT_EQ(a.particles.specific_energy, b.particles.specific_energy);
    EXPECT_EQ(a.particles.id, b.particles.id);
    ASSERT_EQ(a.grid.size(), b.grid.size());
    for (std::size_t n = 0; n < a.grid.size(); ++n)
        EXPECT_EQ(a.grid[n].values, b.grid[n].values);
    EXPECT_EQ(a.steering, b.steering);
    EXPECT_EQ(a.journal, b.journal);
    EXPECT_EQ(a.ledger, b.ledger);
}

} // namespace meltscope::testing
