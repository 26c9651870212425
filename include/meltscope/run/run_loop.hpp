#pragma once

#include "meltscope/run/cadence.hpp"
#include "meltscope/run/measure.hpp"
#include "meltscope/run/simulation.hpp"
#include "meltscope/run/solidification.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// The loop that every run goes through, whoever steers it and wherever its results go.
namespace meltscope {

/// What is asked for at the present instant.
struct Due {
    bool output = false; ///< data files and a row of the table
    bool picture = false;
    bool checkpoint = false;

    bool any() const { return output || picture || checkpoint; }
};

/// When outputs come. Steerable between steps.
struct OutputSchedule {
    Cadence output;
    std::optional<Cadence> picture; ///< unset: with every output
    Cadence checkpoint;
    ParticleSelection particles = ParticleSelection::surface; ///< that a snapshot holds
};

/// Wall seconds of a run by phase.
struct WallSeconds {
    double solver = 0.0;    ///< steps 3 to 7
    double level_set = 0.0; ///< steps 1 and 2, and what follows from the geometry
    double in_situ = 0.0;   ///< making snapshots and handing them to pictures, as far as the solver waited
    double output = 0.0;    ///< tables and checkpoints
};

/// A run as those who steer it see it. What they change takes effect at the next step.
struct Run {
    Simulation simulation;
    OutputSchedule schedule;
    std::string journal;                          ///< what changed the run so far; goes into checkpoints
    std::int64_t layers_laid = 0;                 ///< of the scenario's powder layers; see scheduled_layers
    std::optional<Solidification> solidification; ///< recorded after every step; unset: not wanted

    std::optional<double> until;            ///< s: pause for good at this time, if it comes before the end
    std::optional<std::int64_t> last_step;  ///< the same, at this step
    std::optional<std::string> stop_reason; ///< set by whoever wants the run to stop now, with a checkpoint
    Due wanted;                             ///< set by whoever wants an output beside the schedule, now
    Due handed_out; ///< at the present instant so far; cleared by whoever puts the run back to another one
    /// Set by the loop: hands out what is wanted at once, for a source of commands that waits.
    std::function<void()> hand_out_wanted;

    WallSeconds wall;
};

/// Where commands come from: a console, a script, a journal, a signal.
struct CommandSource {
    /// Called before every step, with the state at rest; may change the run, and may wait (a pause).
    std::function<void(Run&)> apply;
    /// The next time, s, at which apply() must be called on the dot; the step before lands there. May be
    /// empty.
    std::function<double(const Run&)> next_time = {};
};

/// Where results go. `take` is called at every instant with something due that it wants.
struct Sink {
    enum class Wants { snapshot, state };
    Wants wants = Wants::snapshot;
    double WallSeconds::*phase = &WallSeconds::output; ///< which account its time goes to
    /// `snapshot` is null for sinks that want the state alone.
    std::function<void(const Run&, const Due&, const std::shared_ptr<const Snapshot>& snapshot)> take;
};

/// All that is connected to a loop, in the order in which it is called.
struct RunConnections {
    std::vector<CommandSource> commands;
    std::vector<std::function<void(const Run&)>> after_step; ///< who only looks on
    std::vector<Sink> sinks;
};

/// What the schedule asks for at the present instant.
Due due_now(const Run& run);

enum class RunOutcome {
    done,     ///< reached its end
    interval, ///< reached `until` or `last_step` before its end; a checkpoint was asked for
    stopped   ///< stop_reason was set; a checkpoint was asked for
};

/// Steps a run to its end. Outputs come at the instants of the schedule, the start of a run (and the instant
/// at which a checkpoint is taken up again, if it belongs to the schedule) and its end. The only place where
/// the length of a step's target is chosen: the next instant that anybody waits for. Throws
/// std::runtime_error if the solution is no longer finite, and whatever a sink or source throws.
RunOutcome run_to_end(Run& run, const RunConnections& connections);

} // namespace meltscope
