#pragma once

namespace meltscope {

/// Tells when a run has to stop so that all that still follows ends before a limit of wall time. All times
/// are wall seconds; `now` counts from the start of the run, by the clock of whoever calls.
class WallLimit {
  public:
    /// infinity: no limit.
    explicit WallLimit(double limit) : limit_(limit), stop_at_(limit) {}

    double limit() const { return limit_; }

    /// A step has just ended; what is handed out after it is still to come.
    void step_ended(double now) { step_ended_ = now; }

    /// The run may stop here or take another step. `in_steps` is what all steps took so far, without any wait
    /// for commands before them; `rest` is what follows a stop: the checkpoint and pictures under way.
    void before_step(double now, double in_steps, double rest);

    /// Whether there is no longer time for another round like the longest so far (a step, what was handed out
    /// after it, layers laid) and the rest, with half as much to spare.
    bool reached(double now) const { return now >= stop_at_; }

  private:
    double limit_;
    double stop_at_;
    double step_ended_ = -1.0; ///< negative: there was no step yet
    double in_steps_ = 0.0;    ///< at the last call of before_step
    double longest_round_ = 0.0;
};

} // namespace meltscope
