#include "block.hpp"

#include "meltscope/run/run_loop.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

using namespace meltscope;
using namespace meltscope::test;

namespace {

struct Event {
    double time;
    std::int64_t step;
    Due due;
};

/// A run of ten steps or so that notes what its loop hands out.
struct Observed {
    Run run;
    std::vector<Event> outputs, pictures, checkpoints;
    int snapshots = 0;
    RunConnections connections;

    explicit Observed(double end = 1e-4) {
        run.simulation = steel_block(0.7);
        run.simulation.parameters.time.end = end;
        run.simulation.parameters.time.max_step = 1e-5;
        run.schedule.output.every = 4e-5;
        connections.sinks.push_back(
            {Sink::Wants::snapshot, &WallSeconds::output,
             [this](const Run& r, const Due& due, const std::shared_ptr<const Snapshot>& snapshot) {
                 ++snapshots;
                 EXPECT_EQ(snapshot->step, r.simulation.step);
                 const Event event{r.simulation.time, r.simulation.step, due};
                 if (due.output)
                     outputs.push_back(event);
                 if (due.picture)
                     pictures.push_back(event);
             }});
        connections.sinks.push_back(
            {Sink::Wants::state, &WallSeconds::output,
             [this](const Run& r, const Due& due, const std::shared_ptr<const Snapshot>& snapshot) {
                 EXPECT_EQ(snapshot, nullptr);
                 if (due.checkpoint)
                     checkpoints.push_back({r.simulation.time, r.simulation.step, due});
             }});
    }
    Observed(const Observed&) = delete;
    Observed& operator=(const Observed&) = delete;

    RunOutcome go() { return run_to_end(run, connections); }
};

std::vector<double> times(const std::vector<Event>& events) {
    std::vector<double> result;
    for (const Event& event : events)
        result.push_back(event.time);
    return result;
}

} // namespace

TEST(RunLoop, outputs_come_at_the_start_at_their_instants_and_at_the_end) {
    Observed observed;
    EXPECT_EQ(observed.go(), RunOutcome::done);
    const std::vector<double> expected{0.0, 4e-5, 8e-5, 1e-4};
    EXPECT_EQ(times(observed.outputs), expected);
    EXPECT_EQ(times(observed.pictures), expected);
    EXPECT_TRUE(observed.checkpoints.empty());
    EXPECT_EQ(observed.run.simulation.time, 1e-4);
}

TEST(RunLoop, pictures_may_have_instants_of_their_own_and_share_snapshots) {
    Observed observed;
    observed.run.schedule.picture = Cadence{2e-5, {}};
    observed.go();
    EXPECT_EQ(times(observed.pictures), (std::vector<double>{0.0, 2e-5, 4e-5, 3 * 2e-5, 8e-5, 1e-4}));
    EXPECT_EQ(observed.outputs.size(), 4u);
    EXPECT_EQ(observed.snapshots, 7); // the end is known to be one only after the picture that is due there
}

TEST(RunLoop, an_interval_by_steps_changes_no_step) {
    Observed by_steps, alone;
    by_steps.run.schedule.output = {{}, 3};
    alone.run.schedule.output = {};
    by_steps.go();
    alone.go();
    EXPECT_EQ(by_steps.run.simulation.step, alone.run.simulation.step);
    EXPECT_EQ(by_steps.run.simulation.ledger.stored, alone.run.simulation.ledger.stored);
    for (std::size_t n = 0; n + 1 < by_steps.outputs.size(); ++n)
        EXPECT_EQ(by_steps.outputs[n].step, std::int64_t(3 * n));
}

TEST(RunLoop, checkpoints_come_at_their_instants_and_at_the_end_but_not_at_the_start) {
    Observed observed;
    observed.run.schedule.checkpoint.every = 3e-5;
    observed.go();
    EXPECT_EQ(times(observed.checkpoints), (std::vector<double>{3e-5, 6e-5, 3 * 3e-5, 1e-4}));
}

TEST(RunLoop, commands_are_applied_before_every_step_and_on_the_dot_where_they_ask_for_it) {
    Observed observed;
    int calls = 0;
    double met = -1.0;
    observed.connections.commands.push_back({[&](meltscope::Run& run) {
                                                 ++calls;
                                                 if (run.simulation.time >= 2.5e-5 && met < 0.0)
                                                     met = run.simulation.time;
                                             },
                                             [](const meltscope::Run&) { return 2.5e-5; }});
    observed.go();
    EXPECT_EQ(met, 2.5e-5);
    EXPECT_EQ(calls, observed.run.simulation.step + 1); // and once when nothing is left
}

TEST(RunLoop, a_command_may_move_the_end) {
    Observed observed(5e-5);
    observed.connections.commands.push_back({[](meltscope::Run& run) {
        if (run.simulation.time >= 5e-5)
            run.simulation.parameters.time.end = 1e-4;
    }});
    EXPECT_EQ(observed.go(), RunOutcome::done);
    EXPECT_EQ(times(observed.outputs), (std::vector<double>{0.0, 4e-5, 8e-5, 1e-4}));
}

TEST(RunLoop, a_stop_leaves_a_checkpoint_and_no_output) {
    Observed observed;
    observed.connections.commands.push_back({[](meltscope::Run& run) {
        if (run.simulation.step == 6)
            run.stop_reason = "enough";
    }});
    EXPECT_EQ(observed.go(), RunOutcome::stopped);
    ASSERT_EQ(observed.checkpoints.size(), 1u);
    EXPECT_EQ(observed.checkpoints[0].step, 6);
    EXPECT_EQ(observed.outputs.size(), 2u);
}

TEST(RunLoop, an_interval_that_was_asked_for_ends_with_output_and_checkpoint) {
    Observed by_step, by_time;
    by_step.run.last_step = 5;
    by_time.run.until = 6.5e-5;
    EXPECT_EQ(by_step.go(), RunOutcome::interval);
    EXPECT_EQ(by_time.go(), RunOutcome::interval);
    EXPECT_EQ(by_step.run.simulation.step, 5);
    EXPECT_EQ(by_time.run.simulation.time, 6.5e-5);
    for (const Observed* observed : {&by_step, &by_time}) {
        EXPECT_EQ(observed->checkpoints.size(), 1u);
        EXPECT_EQ(observed->outputs.back().step, observed->run.simulation.step);
    }
}

TEST(RunLoop, an_output_that_is_wanted_beside_the_schedule_comes_at_once) {
    Observed observed;
    observed.connections.commands.push_back({[](meltscope::Run& run) {
        if (run.simulation.step == 2)
            run.wanted.checkpoint = true;
    }});
    observed.go();
    ASSERT_EQ(observed.checkpoints.size(), 1u);
    EXPECT_EQ(observed.checkpoints[0].step, 2);
}

TEST(RunLoop, a_solution_that_is_no_longer_finite_ends_the_run) {
    Observed observed;
    observed.run.simulation.particles.specific_energy[observed.run.simulation.particles.layout.place[0]] =
        std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(observed.go(), std::runtime_error);
}
