#pragma once

#include <stdexcept>

namespace meltscope {

/// What the program tells its caller.
namespace exit_code {
inline constexpr int done = 0;
inline constexpr int failed = 1;  ///< the run failed
inline constexpr int usage = 2;   ///< bad usage or bad input
inline constexpr int stopped = 3; ///< stopped on request, with a checkpoint
} // namespace exit_code

/// Bad usage or bad input; the message says what would be right.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

} // namespace meltscope
