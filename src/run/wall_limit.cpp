#include "meltscope/run/wall_limit.hpp"

#include <algorithm>

namespace meltscope {

void WallLimit::before_step(double now, double in_steps, double rest) {
    constexpr double spare = 1.5; // the next round may be longer than any before, the disk slower
    if (step_ended_ >= 0.0)
        longest_round_ = std::max(longest_round_, (in_steps - in_steps_) + (now - step_ended_));
    in_steps_ = in_steps;
    stop_at_ = limit_ - spare * (longest_round_ + rest);
}

} // namespace meltscope
