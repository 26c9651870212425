#include "meltscope/run/wall_limit.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace meltscope {
namespace {

/// A run on a clock of its own: rounds of a step and of what is handed out after it, until it is to stop.
struct TimedRun {
    explicit TimedRun(double limit) : wall_limit(limit) {}

    /// Whether the round was taken.
    bool round(double step, double handed_out, double rest, double waited = 0.0) {
        wall_limit.before_step(now, in_steps, rest);
        now += waited;
        if (wall_limit.reached(now))
            return false;
        now += step;
        in_steps += step;
        wall_limit.step_ended(now);
        now += handed_out;
        return true;
    }

    WallLimit wall_limit;
    double now = 0.0, in_steps = 0.0;
};

} // namespace

TEST(WallLimit, leaves_room_for_another_round_and_what_follows_it) {
    TimedRun run(100.0);
    while (run.round(2.0, 1.0, 5.0))
        ASSERT_LT(run.now, 100.0);
    EXPECT_LE(run.now + 3.0 + 5.0, 100.0);         // even if the round had been taken
    EXPECT_GE(run.now, 100.0 - 2.0 * (3.0 + 5.0)); // and most of the time is used
}

TEST(WallLimit, expects_the_longest_round_again) {
    TimedRun run(100.0);
    for (int n = 0; n < 90 && run.round(1.0, n % 71 == 0 ? 19.0 : 0.0, 0.0); ++n) {
    }
    EXPECT_LE(run.now + 20.0, 100.0); // the next long one would have begun at 90 s
    EXPECT_GE(run.now, 60.0);
}

TEST(WallLimit, follows_what_is_still_to_be_written) {
    TimedRun run(100.0);
    for (int n = 0; n < 10; ++n)
        EXPECT_TRUE(run.round(1.0, 0.0, 50.0)); // needs 51 of 90 s
    EXPECT_TRUE(run.round(1.0, 0.0, 50.0));
    EXPECT_FALSE(run.round(1.0, 0.0, 80.0)); // needs 81 of 89 s, and half as much to spare
    EXPECT_TRUE(run.round(1.0, 0.0, 50.0));
}

TEST(WallLimit, takes_no_wait_for_commands_for_a_round) {
    TimedRun run(1000.0);
    ASSERT_TRUE(run.round(1.0, 0.0, 0.0));
    ASSERT_TRUE(run.round(1.0, 0.0, 0.0, 600.0)); // somebody thinks at the prompt
    EXPECT_TRUE(run.round(1.0, 0.0, 0.0));
    EXPECT_GT(run.now, 600.0);
}

TEST(WallLimit, ends_a_wait_for_commands_too) {
    TimedRun run(1000.0);
    ASSERT_TRUE(run.round(1.0, 0.0, 10.0));
    EXPECT_FALSE(run.round(1.0, 0.0, 10.0, 990.0));
}

TEST(WallLimit, without_a_limit_is_never_reached) {
    TimedRun run(std::numeric_limits<double>::infinity());
    for (int n = 0; n < 3; ++n)
        EXPECT_TRUE(run.round(1e6, 1e6, 1e6));
}

} // namespace meltscope
