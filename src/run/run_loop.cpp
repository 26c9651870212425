#include "meltscope/run/run_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace meltscope {
namespace {

class Stopwatch {
  public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

bool at_end(const Run& run) {
    const double time = run.simulation.time;
    return time >= run.simulation.parameters.time.end ||
           (run.until && (time >= *run.until || same_instant(time, *run.until))) ||
           (run.last_step && run.simulation.step >= *run.last_step);
}

const Cadence& picture_cadence(const OutputSchedule& schedule) {
    return schedule.picture ? *schedule.picture : schedule.output;
}

/// The next instant that anybody waits for, s.
double next_target(const Run& run, const std::vector<CommandSource>& commands) {
    const double time = run.simulation.time;
    // In order of precedence: of instants that are the same but for round-off the first is landed on.
    std::vector<double> instants{run.simulation.parameters.time.end};
    for (const CommandSource& source : commands)
        if (source.next_time)
            if (const double next = source.next_time(run); next > time && !same_instant(next, time))
                instants.push_back(next);
    instants.push_back(next_due(run.schedule.output, time));
    instants.push_back(next_due(picture_cadence(run.schedule), time));
    instants.push_back(next_due(run.schedule.checkpoint, time));
    instants.push_back(run.until.value_or(never)); // last: to stop there and go on must leave no trace
    const double first = *std::min_element(instants.begin(), instants.end());
    return *std::find_if(instants.begin(), instants.end(),
                         [&](double t) { return t == first || same_instant(t, first); });
}

Due both(const Due& a, const Due& b) {
    return {a.output || b.output, a.picture || b.picture, a.checkpoint || b.checkpoint};
}

Due without(const Due& a, const Due& b) {
    return {a.output && !b.output, a.picture && !b.picture, a.checkpoint && !b.checkpoint};
}

void advance_timed(Run& run, double target) {
    Simulation& simulation = run.simulation;
    const double level_set_before = simulation.seconds_in_level_set;
    const Stopwatch watch;
    advance(simulation, target);
    const double level_set = simulation.seconds_in_level_set - level_set_before;
    if (run.solidification)
        record_solidification(simulation, *run.solidification);
    run.wall.solver += watch.seconds() - level_set;
    run.wall.level_set += level_set;
}

void require_finite(const Simulation& simulation) {
    if (!std::isfinite(simulation.ledger.stored))
        throw std::runtime_error(fmt::format(
            "the solution is no longer finite at step {}, t = {:.6g} s; a smaller time.cfl may help",
            simulation.step, simulation.time));
}

void hand_out(Run& run, const std::vector<Sink>& sinks, const Due& due) {
    if (!due.any())
        return;
    balance(run.simulation);
    require_finite(run.simulation);
    std::shared_ptr<const Snapshot> snapshot;
    if (due.output || due.picture) {
        const Stopwatch watch;
        snapshot = std::make_shared<const Snapshot>(
            take_snapshot(run.simulation, due.output ? run.schedule.particles : ParticleSelection::none));
        run.wall.in_situ += watch.seconds();
    }
    for (const Sink& sink : sinks) {
        const bool wants_snapshot = sink.wants == Sink::Wants::snapshot;
        if (wants_snapshot && !snapshot)
            continue;
        const Stopwatch watch;
        sink.take(run, due, wants_snapshot ? snapshot : nullptr);
        run.wall.*sink.phase += watch.seconds();
    }
}

/// What the last instant of this call gives beyond the schedule.
Due due_at_end(const Run& run, RunOutcome outcome) {
    if (outcome == RunOutcome::stopped)
        return {false, false, true};
    return {true, true,
            outcome == RunOutcome::interval || run.schedule.checkpoint.every.has_value() ||
                run.schedule.checkpoint.every_steps.has_value()};
}

} // namespace

Due due_now(const Run& run) {
    const double time = run.simulation.time;
    const std::int64_t step = run.simulation.step;
    return {is_due(run.schedule.output, time, step), is_due(picture_cadence(run.schedule), time, step),
            is_due(run.schedule.checkpoint, time, step)};
}

RunOutcome run_to_end(Run& run, const RunConnections& connections) {
    run.wall.level_set += run.simulation.seconds_in_level_set; // of setting the run up
    run.handed_out = due_now(run);
    run.handed_out.checkpoint =
        false; // the start can be had from the scenario, and a checkpoint taken up is there already
    hand_out(run, connections.sinks, run.handed_out);
    run.hand_out_wanted = [&] {
        const Due asked = without(run.wanted, run.handed_out);
        run.wanted = {};
        hand_out(run, connections.sinks, asked);
        run.handed_out = both(run.handed_out, asked);
    };
    for (;;) {
        for (const CommandSource& source : connections.commands)
            source.apply(run);
        if (run.stop_reason || at_end(run))
            break;
        run.hand_out_wanted();

        advance_timed(run, next_target(run, connections.commands));
        for (const auto& look : connections.after_step)
            look(run);
        run.handed_out = due_now(run);
        hand_out(run, connections.sinks, run.handed_out);
    }
    const RunOutcome outcome = run.simulation.time >= run.simulation.parameters.time.end ? RunOutcome::done
                               : run.stop_reason                                         ? RunOutcome::stopped
                                                 : RunOutcome::interval;
    hand_out(run, connections.sinks, without(both(due_at_end(run, outcome), run.wanted), run.handed_out));
    run.wanted = {};
    run.hand_out_wanted = {};
    return outcome;
}

} // namespace meltscope
