#pragma once

#include "meltscope/run/run_loop.hpp"

#include <stdexcept>
#include <string>
#include <vector>

namespace meltscope {

/// Steering text that cannot be read; the message names the key.
struct SteeringError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// What of a run can change while it is under way.
struct Steering {
    Boundary boundary;
    std::vector<Laser> lasers;
    PhysicsOptions physics;
    LevelSetOptions level_set;
    TimeOptions time;
    OutputSchedule schedule;
};

/// The steering as it stands.
Steering steering_of(const RunParameters& parameters, const OutputSchedule& schedule);

/// Puts the steering in force.
void apply_steering(const Steering& steering, RunParameters& parameters, OutputSchedule& schedule);

/// The steering as JSON. Numbers read back bit for bit.
std::string steering_text(const Steering& steering);

/// Reads steering_text's text. Throws SteeringError.
Steering read_steering(const std::string& text);

/// `steered` with all that `changed` has different from `original`: for a run that was steered and goes on
/// under another scenario than it began with. Lasers are matched one by one if there are as many of them.
Steering with_changes(const Steering& steered, const Steering& original, const Steering& changed);

} // namespace meltscope
