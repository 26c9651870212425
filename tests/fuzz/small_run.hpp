#pragma once

#include "meltscope/io/run_state.hpp"

#include "../started_run.hpp"

#include <algorithm>
#include <string>

/// A run of a few hundred particles for whatever needs one: two materials, two lasers, powder.
namespace meltscope::fuzz {

inline constexpr const char* small_scenario = R"(
title = "small"
[material.metal]
density = 8000
solidus = 1600
liquidus = 1700
latent_heat = 2e5
conductivity = {solid = [20], liquid = [30], powder = [0.2]}
heat_capacity = {solid = [600], liquid = [700]}
emissivity = 0.4
boiling_point = 3000
latent_heat_of_vaporization = 7e6
molar_mass = 0.0558
[material.other]
density = 4000
solidus = 1900
liquidus = 1950
latent_heat = 3e5
conductivity = {solid = [10], liquid = [20]}
heat_capacity = {solid = [500, 0.1], liquid = [900]}
[domain]
min = [0, 0, 0]
max = [160e-6, 120e-6, 120e-6]
cell_size = 20e-6
particles_per_cell = 1
[[body]]
shape = "box"
material = "metal"
min = [0, 0, 0]
max = [160e-6, 120e-6, 40e-6]
[[body]]
shape = "box"
material = "other"
min = [0, 0, 0]
max = [60e-6, 120e-6, 20e-6]
[[body]]
shape = "box"
material = "metal"
state = "powder"
packing = 0.5
min = [0, 0, 40e-6]
max = [160e-6, 120e-6, 60e-6]
[[laser]]
name = "red"
power = 10
spot_radius = 30e-6
absorptivity = 0.4
path = [{move = [40e-6, 60e-6, 60e-6]}, {to = [120e-6, 60e-6, 60e-6], speed = 0.5}]
[[laser]]
name = "blue"
power = 5
spot_radius = 40e-6
absorptivity = 0.3
path = [{move = [80e-6, 20e-6, 60e-6]}, {dwell = 40e-6}, {to = [80e-6, 100e-6, 60e-6], speed = 1}]
[physics]
convection = 20
[boundary]
z_min = {temperature = 300}
[time]
end = 200e-6
max_step = 4e-6
[output]
every = 40e-6
solidification = true
)";

inline Scenario read_small() {
    return read_scenario_text(small_scenario);
}

inline Run start_small() {
    Run run = testing::started(read_small());
    run.solidification = begin_solidification(run.simulation);
    return run;
}

inline ConsoleHost small_host() {
    return testing::host_for(read_small());
}

/// One step as the run loop takes it: towards the next instant that the console waits for.
inline void step(const ConsoleState& console, Run& run) {
    advance(run.simulation,
            std::min(run.simulation.parameters.time.end, next_landing(console, run.simulation.time)));
    if (run.solidification)
        record_solidification(run.simulation, *run.solidification);
}

/// A console as new. Field by field: a new one reads the unit database, which takes longer than a session.
inline void renew(ConsoleState& console, const ConsoleHost& host) {
    console.host = host;
    console.render = host.render;
    console.running = true;
    console.leaves = false;
    console.goal = {};
    console.waiting.clear();
    console.landings.clear();
    console.lines.clear();
    console.recording.clear();
    console.sourced.clear();
    console.sourced_from.clear();
    console.must_succeed = false;
    console.from_journal = false;
    console.journal_written = 0;
}

} // namespace meltscope::fuzz
