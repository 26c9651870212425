#pragma once

#include "run_outputs.hpp"
#include "terminal.hpp"

#include "meltscope/run/run_loop.hpp"

#include <chrono>
#include <vector>

namespace meltscope {

/// Looks on while a run is stepped: draws the progress, and logs what rules the time step, how far the
/// particles are from the nodes, and lasers whose light the surface takes up badly.
class StepWatch {
  public:
    StepWatch(Terminal& terminal, const RunOutputs& outputs) : terminal_(terminal), outputs_(outputs) {}

    /// To be called after every step.
    void after_step(const Run& run);
    /// Reports every output.
    Sink sink();

  private:
    void log_step_size(const Simulation& simulation);
    void check_lasers(const Simulation& simulation);
    void measure_speed(const Run& run);
    Progress progress_of(const Run& run) const;

    Terminal& terminal_;
    const RunOutputs& outputs_;
    StepLimit logged_limit_ = StepLimit::landing;
    double logged_dt_ = 0.0; ///< s
    std::vector<bool> warned_;

    // Where the present stretch of the speed measurement began.
    std::chrono::steady_clock::time_point stretch_start_{};
    double stretch_solver_seconds_ = 0.0;
    std::int64_t stretch_step_ = 0;
    double stretch_time_ = 0.0;              ///< s, simulated
    double particle_steps_per_second_ = 0.0; ///< of the solver alone
    double time_rate_ = 0.0;                 ///< simulated seconds a wall second
};

} // namespace meltscope
