#pragma once

#include "run_outputs.hpp"
#include "stopwatch.hpp"
#include "terminal.hpp"

#include "meltscope/run/wall_limit.hpp"

#include <optional>
#include <string>

namespace meltscope {

/// Signals and the wall clock, as they stop a run. The clock starts when this is made.
class Stops {
  public:
    /// `wall_limit` in s; infinity: none.
    explicit Stops(double wall_limit) : wall_limit_(wall_limit) {}

    /// Why the run is to stop, if a signal or the wall clock says so.
    std::optional<std::string> request() const;

    /// Whether the run's time is used up.
    bool out_of_time() const { return wall_limit_.reached(since_start_.seconds()); }

    /// Both as a source of commands; makes a checkpoint, too, when a signal asks for one.
    CommandSource source(const RunOutputs& outputs, Terminal& terminal);

    /// To be called when a step has ended, before anything is handed out.
    void after_step() { wall_limit_.step_ended(since_start_.seconds()); }

  private:
    Stopwatch since_start_;
    WallLimit wall_limit_;
};

} // namespace meltscope
