#include "meltscope/run/cadence.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace meltscope;

TEST(Cadence, due_times_are_multiples_that_are_never_summed_up) {
    const Cadence cadence{1e-4, {}};
    double time = 0.0;
    for (int k = 1; k <= 100000; ++k) {
        time = next_due(cadence, time);
        ASSERT_EQ(time, k * 1e-4);
    }
}

TEST(Cadence, the_next_due_time_follows_from_the_present_alone) {
    const Cadence cadence{3e-5, {}};
    for (const double time : {0.0, 1e-5, 2.99999e-5, 4.1e-5, 8.9e-5})
        EXPECT_EQ(next_due(cadence, time), std::floor(time / 3e-5 + 1.0) * 3e-5);
}

TEST(Cadence, an_instant_reached_but_for_round_off_is_due_and_does_not_come_again) {
    const Cadence cadence{4e-5, {}};
    const double exact = 3 * 4e-5;
    for (const double time : {exact, std::nextafter(exact, 0.0), std::nextafter(exact, 1.0), 1.2e-4}) {
        EXPECT_TRUE(is_due(cadence, time, 7)) << time;
        EXPECT_EQ(next_due(cadence, time), 4 * 4e-5) << time;
    }
    EXPECT_FALSE(is_due(cadence, 1.3e-4, 7));
}

TEST(Cadence, steps_are_counted_and_need_no_landing) {
    const Cadence cadence{{}, 30};
    EXPECT_TRUE(is_due(cadence, 0.123, 60));
    EXPECT_FALSE(is_due(cadence, 0.123, 61));
    EXPECT_EQ(next_due(cadence, 0.123), never);
}

TEST(Cadence, nothing_is_due_when_nothing_is_set) {
    EXPECT_FALSE(is_due({}, 0.0, 0));
    EXPECT_EQ(next_due({}, 0.0), never);
}

TEST(Cadence, never_is_no_instant_of_any_other) {
    EXPECT_FALSE(same_instant(never, 1.0));
    EXPECT_FALSE(same_instant(0.0, never));
    EXPECT_TRUE(same_instant(never, never));
}
