#pragma once

#include <cstdint>
#include <limits>
#include <optional>

namespace meltscope {

/// When something recurs: at the multiples of a time, of a number of steps, or never (both unset).
/// Due instants are k * every, never summed up, and follow from the present alone: a run that goes on from a
/// checkpoint has the same ones as the run that was not interrupted.
struct Cadence {
    std::optional<double> every;             ///< s, above zero
    std::optional<std::int64_t> every_steps; ///< above zero
};

/// A time that never comes, s.
inline constexpr double never = std::numeric_limits<double>::infinity();

/// Two times are one instant if they differ by round-off only (1e-12 of their value).
bool same_instant(double a, double b);

/// The first multiple of cadence.every after `time`, s; never, if there is none.
double next_due(const Cadence& cadence, double time);

/// True if the instant belongs to the cadence.
bool is_due(const Cadence& cadence, double time, std::int64_t step);

} // namespace meltscope
