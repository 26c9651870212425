#include "stops.hpp"

#include "signals.hpp"
#include "text.hpp"

#include <fmt/format.h>

namespace meltscope {

std::optional<std::string> Stops::request() const {
    if (stop_signal() != 0)
        return "asked to stop by a signal";
    if (out_of_time())
        return fmt::format("another step might not end within the wall limit of {}",
                           clock_time(wall_limit_.limit()));
    return std::nullopt;
}

CommandSource Stops::source(const RunOutputs& outputs, Terminal& terminal) {
    const auto apply = [this, &outputs, &terminal](Run& run) {
        wall_limit_.before_step(since_start_.seconds(), run.wall.solver + run.wall.level_set,
                                outputs.seconds_to_stop(run));
        if (const auto reason = request())
            run.stop_reason = *reason;
        if (take_checkpoint_request()) {
            terminal.note("asked for a checkpoint by a signal");
            run.wanted.checkpoint = true;
        }
    };
    return {apply};
}

} // namespace meltscope
