#include "meltscope/lanes.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace meltscope {
namespace {

TEST(LaneGroups, select_chooses_lane_by_lane) {
    const Lanes index([](int lane) { return double(lane); });
    for (int bound = 0; bound <= lane_count; ++bound) {
        const Lanes chosen = select(index < double(bound), index + 100.0, -index);
        for (int lane = 0; lane < lane_count; ++lane)
            EXPECT_EQ(chosen[lane], lane < bound ? lane + 100.0 : -double(lane)) << bound;
    }
}

TEST(LaneGroups, the_less_and_the_greater_are_taken_lane_by_lane) {
    const Lanes up([](int lane) { return double(lane); }),
        down([](int lane) { return lane_count - 1.5 * lane; });
    const Lanes less = min(up, down), greater = max(up, down);
    for (int lane = 0; lane < lane_count; ++lane) {
        EXPECT_EQ(less[lane], std::min<double>(up[lane], down[lane]));
        EXPECT_EQ(greater[lane], std::max<double>(up[lane], down[lane]));
    }
}

TEST(LaneGroups, conditions_combine_lane_by_lane) {
    const Lanes index([](int lane) { return double(lane); });
    const auto low = index<1.0, high = index> 1.0;
    for (int lane = 0; lane < lane_count; ++lane) {
        EXPECT_EQ((low || high)[lane], lane != 1);
        EXPECT_FALSE((low && high)[lane]);
        EXPECT_EQ((!low)[lane], lane >= 1);
    }
    EXPECT_TRUE(any_of(low));
    EXPECT_TRUE(none_of(low && high));
    EXPECT_EQ(all_of(low || high), lane_count == 1);
}

} // namespace
} // namespace meltscope
