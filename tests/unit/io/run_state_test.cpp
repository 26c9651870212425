#include "../run/block.hpp"

#include "meltscope/io/run_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace meltscope;
using namespace meltscope::test;

namespace {

Laser weird_laser() {
    Laser laser;
    laser.name = "b";
    laser.power = 100.0 / 3.0;
    laser.absorptivity = 0.1 + 0.2;
    laser.spot_radius = 4e-5;
    laser.profile = BeamProfile::super_gaussian;
    laser.direction = Vec3(0.0, 0.1, -1.0).normalized();
    laser.path.start = Vec3(1.0 / 3.0, 1e-300, -0.0);
    laser.path.segments.push_back({PathSegment::Kind::line, Vec3(1, 2, 3), 0.8, 0.0, 55.5, true});
    laser.path.segments.push_back({PathSegment::Kind::dwell, Vec3(1, 2, 3), 0.0, 1e-3, std::nullopt, false});
    return laser;
}

Steering weird_steering() {
    Steering steering;
    steering.boundary[2] = {FaceCondition::Kind::convection, 300.0, 12.5, 0.0};
    steering.lasers = {Laser{}, weird_laser()};
    steering.lasers[0].spot_radius = 1e-5;
    steering.physics.blend_time = 1e-5 / 3.0;
    steering.physics.radiation = true;
    steering.physics.quiescent_tolerance = 1e-4 / 3.0;
    steering.time = {2e-3, 0.4, std::nullopt};
    steering.schedule.output.every_steps = 7;
    steering.schedule.picture = Cadence{1e-5, std::nullopt};
    steering.schedule.particles = ParticleSelection::melt;
    return steering;
}

Run stepped_block() {
    Run run;
    run.simulation = steel_block(0.7);
    run.journal = "at step 1 t=0: power 5\n";
    for (int n = 0; n < 3; ++n)
        advance(run.simulation, 1.0);
    balance(run.simulation);
    return run;
}

} // namespace

TEST(Steering, reads_back_bit_for_bit) {
    const Steering steering = weird_steering();
    const Steering back = read_steering(steering_text(steering));
    EXPECT_EQ(steering_text(back), steering_text(steering));
    EXPECT_EQ(back.lasers[1].power, 100.0 / 3.0);
    EXPECT_EQ(back.lasers[1].path, steering.lasers[1].path);
    EXPECT_EQ(back.physics.blend_time, steering.physics.blend_time);
    EXPECT_EQ(back.physics.quiescent_tolerance, steering.physics.quiescent_tolerance);
    EXPECT_FALSE(back.time.max_step.has_value());
    EXPECT_EQ(back.schedule.picture->every, 1e-5);
    EXPECT_EQ(back.boundary[2].coefficient, 12.5);
}

TEST(Steering, text_that_is_none_is_refused_by_its_key) {
    EXPECT_THROW(read_steering(""), SteeringError);
    std::string text = steering_text(weird_steering());
    text.replace(text.find("\"cfl\""), 5, "\"xyz\"");
    try {
        read_steering(text);
        FAIL();
    } catch (const SteeringError& error) {
        EXPECT_NE(std::string(error.what()).find("cfl"), std::string::npos);
    }
}

TEST(Steering, values_that_no_command_leads_to_are_refused_by_their_key) {
    const auto refusal = [](auto change) {
        Steering steering = weird_steering();
        change(steering);
        try {
            read_steering(steering_text(steering));
        } catch (const SteeringError& error) {
            return std::string(error.what());
        }
        return std::string("taken");
    };
    const auto expect = [&](const char* key, auto change) {
        EXPECT_NE(refusal(change).find(key), std::string::npos) << refusal(change);
    };
    EXPECT_EQ(refusal([](Steering&) {}), "taken");
    expect("boundary.temperature", [](Steering& s) { s.boundary[2].temperature = -1.0; });
    expect("lasers.power", [](Steering& s) { s.lasers[1].power = -1.0; });
    expect("lasers.spot_radius", [](Steering& s) { s.lasers[1].spot_radius = 0.0; });
    expect("lasers.absorptivity", [](Steering& s) { s.lasers[1].absorptivity = 2.0; });
    expect("lasers.direction", [](Steering& s) { s.lasers[1].direction.setZero(); });
    expect("segment", [](Steering& s) { s.lasers[1].path.segments[0].speed = -0.8; });
    expect("time.cfl", [](Steering& s) { s.time.cfl = 0.0; });
    expect("time.end", [](Steering& s) { s.time.end = 0.0; });
    expect("schedule.every_steps", [](Steering& s) { s.schedule.output.every_steps = 0; });
    expect("schedule.every", [](Steering& s) { s.schedule.picture->every = -1e-5; });
    expect("physics.quiescent_tolerance", [](Steering& s) { s.physics.quiescent_tolerance = -1e-6; });
    expect("level_set.radius", [](Steering& s) { s.level_set.radius = 1e9; });
}

TEST(Steering, what_the_new_scenario_changes_wins_and_what_was_steered_stays) {
    const Steering original = weird_steering();
    Steering steered = original, changed = original;
    steered.lasers[1].power = 77.0; // by the console
    steered.lasers[0].absorptivity = 0.9;
    changed.time.end = 5e-3; // by the scenario
    changed.lasers[0].absorptivity = 0.5;
    const Steering result = with_changes(steered, original, changed);
    EXPECT_EQ(result.lasers[1].power, 77.0);
    EXPECT_EQ(result.lasers[0].absorptivity, 0.5);
    EXPECT_EQ(result.time.end, 5e-3);
    EXPECT_EQ(result.time.cfl, 0.4);
}

TEST(RunState, a_simulation_taken_from_a_checkpoint_goes_on_bit_for_bit) {
    meltscope::Run run = stepped_block();
    const CheckpointData data = checkpoint_of(run, "title = \"x\"");
    meltscope::Run again;
    again.simulation = simulation_from(data, block_parameters(), block_grid(), 2);
    again.journal = data.journal;
    EXPECT_EQ(again.simulation.least_temperature, run.simulation.least_temperature);
    EXPECT_GT(run.simulation.least_temperature, 0.0);
    for (int n = 0; n < 4; ++n) {
        advance(run.simulation, 1.0);
        advance(again.simulation, 1.0);
    }
    balance(run.simulation);
    balance(again.simulation);
    const CheckpointData a = checkpoint_of(run, ""), b = checkpoint_of(again, "");
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.step, b.step);
    EXPECT_EQ(a.dt, b.dt);
    EXPECT_EQ(a.particles.specific_energy, b.particles.specific_energy);
    EXPECT_EQ(a.grid[0].values, b.grid[0].values);
    EXPECT_EQ(a.ledger, b.ledger);
    EXPECT_EQ(a.journal, b.journal);
}

TEST(RunState, a_simulation_of_which_a_part_sleeps_goes_on_bit_for_bit) {
    RunParameters parameters = block_parameters();
    parameters.physics.quiescent_tolerance = 1e-6;
    const Grid grid = block_grid({26, 8, 8});
    ParticleList list = block_particles(grid, 50e-6, 300.0);
    for (std::int64_t q = 0; q < list.size(); ++q)
        if (list.position[q][0] < 20e-6)
            list.specific_energy[q] *= 2.0;
    meltscope::Run run, again;
    run.simulation = make_simulation(parameters, grid, list, 2);
    advance(run.simulation, 1.0);
    CheckpointData data = checkpoint_of(run, "");
    ASSERT_EQ(data.grid.size(), 3u);
    EXPECT_EQ(data.grid[2].dims, (std::vector<std::uint64_t>{3, 3, 4}));
    const auto awake = std::count(data.grid[2].values.begin(), data.grid[2].values.end(), 1.0);
    EXPECT_GT(awake, 0);
    EXPECT_LT(awake, 4 * 3 * 2);

    again.simulation = simulation_from(data, parameters, grid, 2);
    EXPECT_EQ(again.simulation.quiescence.bricks.awake, run.simulation.quiescence.bricks.awake);
    for (int n = 0; n < 20; ++n) {
        advance(run.simulation, 1.0);
        advance(again.simulation, 1.0);
    }
    const CheckpointData a = checkpoint_of(run, ""), b = checkpoint_of(again, "");
    EXPECT_EQ(a.particles.specific_energy, b.particles.specific_energy);
    EXPECT_EQ(a.grid[0].values, b.grid[0].values);

    data.grid[2].values.pop_back();
    EXPECT_THROW(simulation_from(data, parameters, grid, 2), CheckpointError);
}

TEST(RunState, the_grid_is_saved_without_padding) {
    const CheckpointData data = checkpoint_of(stepped_block(), "");
    EXPECT_EQ(data.grid[0].dims, (std::vector<std::uint64_t>{11, 11, 15}));
    EXPECT_EQ(data.grid[0].values.size(), 11u * 11u * 15u);
}

TEST(RunState, a_checkpoint_that_does_not_fit_is_refused) {
    CheckpointData data = checkpoint_of(stepped_block(), "");
    EXPECT_THROW(simulation_from(data, block_parameters(), block_grid({10, 8, 8}), 2), CheckpointError);
    data.particles.material[3] = 4;
    EXPECT_THROW(simulation_from(data, block_parameters(), block_grid(), 2), CheckpointError);
    data.particles.material[3] = 0;
    data.ledger.pop_back();
    EXPECT_THROW(simulation_from(data, block_parameters(), block_grid(), 2), CheckpointError);
}

TEST(RunState, particles_and_instants_that_no_run_has_are_refused) {
    const CheckpointData good = checkpoint_of(stepped_block(), "");
    const auto expect_refusal = [&](auto change) {
        CheckpointData data = good;
        change(data);
        EXPECT_THROW(simulation_from(data, block_parameters(), block_grid(), 2), CheckpointError);
    };
    EXPECT_NO_THROW(simulation_from(good, block_parameters(), block_grid(), 2));
    const double nan = std::nan("");
    expect_refusal([&](CheckpointData& d) { d.particles.position[7] = nan; });
    expect_refusal([&](CheckpointData& d) { d.particles.mass[7] = 0.0; });
    expect_refusal([&](CheckpointData& d) { d.particles.volume[7] = -1.0; });
    expect_refusal([&](CheckpointData& d) { d.particles.specific_energy[7] = nan; });
    expect_refusal([&](CheckpointData& d) { d.time = nan; });
    expect_refusal([&](CheckpointData& d) { d.time = -1.0; });
    expect_refusal([&](CheckpointData& d) { d.step = -1; });
    CheckpointData layers = good;
    layers.grid.push_back({"layers_laid", {1}, {nan}});
    EXPECT_THROW(layers_laid_by(layers), CheckpointError);
}
