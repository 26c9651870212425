#include "meltscope/beam/scan_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace meltscope {
namespace {

/// 1 mm along x at 1 m/s, 0.5 ms of rest without light, 2 mm along y at 0.5 m/s with 150 W.
ScanPath hook() {
    ScanPath path;
    path.start = Vec3(1e-3, 2e-3, 0.0);
    path.start_time = 1e-4;
    append_line(path, Vec3(2e-3, 2e-3, 0.0), 1.0);
    append_dwell(path, 5e-4, {}, false);
    append_line(path, Vec3(2e-3, 4e-3, 0.0), 0.5, 150.0);
    return path;
}

TEST(ScanPath, beam_runs_lines_at_their_speed_and_rests_in_dwells) {
    const ScanPath path = hook();
    EXPECT_DOUBLE_EQ(path_end_time(path), 1e-4 + 1e-3 + 5e-4 + 4e-3);

    const BeamPosition on_line = beam_at(path, 1e-4 + 2.5e-4);
    EXPECT_LT((on_line.position - Vec3(1.25e-3, 2e-3, 0.0)).norm(), 1e-15);
    EXPECT_EQ(on_line.scan_direction, Vec3::UnitX());
    EXPECT_DOUBLE_EQ(on_line.speed, 1.0);
    EXPECT_TRUE(on_line.on);
    EXPECT_FALSE(on_line.power);

    const BeamPosition resting = beam_at(path, 1.3e-3);
    EXPECT_EQ(resting.position, Vec3(2e-3, 2e-3, 0.0));
    EXPECT_EQ(resting.scan_direction, Vec3::Zero());
    EXPECT_FALSE(resting.on);

    EXPECT_EQ(beam_at(path, 2e-3).power, 150.0);
}

TEST(ScanPath, beam_is_dark_before_the_start_and_after_the_end) {
    const ScanPath path = hook();
    const BeamPosition before = beam_at(path, 0.0);
    EXPECT_EQ(before.position, path.start);
    EXPECT_FALSE(before.on);
    EXPECT_FALSE(before.finished);
    const BeamPosition after = beam_at(path, path_end_time(path));
    EXPECT_EQ(after.position, path_end(path));
    EXPECT_FALSE(after.on);
    EXPECT_TRUE(after.finished);
}

TEST(ScanPath, segment_that_begins_at_a_corner_is_in_force_there) {
    const ScanPath path = hook();
    const std::vector<double> ends = segment_end_times(path);
    EXPECT_TRUE(beam_at(path, path.start_time).on);
    EXPECT_FALSE(beam_at(path, ends[0]).on);
    EXPECT_TRUE(beam_at(path, std::nextafter(ends[0], 0.0)).on);
    EXPECT_TRUE(beam_at(path, ends[1]).on);
    EXPECT_EQ(beam_at(path, ends[1]).position, Vec3(2e-3, 2e-3, 0.0));
}

TEST(ScanPath, corner_times_lead_from_the_start_through_every_segment_end) {
    const ScanPath path = hook();
    std::vector<double> met;
    for (auto time = next_corner_time(path, 0.0); time; time = next_corner_time(path, *time)) {
        met.push_back(*time);
    }
    std::vector<double> expected = segment_end_times(path);
    expected.insert(expected.begin(), path.start_time);
    EXPECT_EQ(met, expected);
}

TEST(ScanPath, corners_part_at_the_beam) {
    const ScanPath path = hook();
    const PathCorners corners = corners_at(path, 1.1e-3 + 5e-4 + 2e-3);
    ASSERT_EQ(corners.done.size(), 3u);
    ASSERT_EQ(corners.to_come.size(), 2u);
    EXPECT_EQ(corners.done.back(), corners.to_come.front());
    EXPECT_LT((corners.done.back().position - Vec3(2e-3, 3e-3, 0.0)).norm(), 1e-15);
    EXPECT_EQ(corners.to_come.back().position, path_end(path));
}

TEST(ScanPath, corners_tell_what_is_run_with_light) {
    ScanPath path; // a line, a way back without light, a line of no power, one with light, a jump
    append_line(path, Vec3(1e-3, 0.0, 0.0), 1.0);
    append_jump(path, Vec3(0.0, 1e-3, 0.0), 1.0);
    append_line(path, Vec3(1e-3, 1e-3, 0.0), 1.0, 0.0);
    append_line(path, Vec3(0.0, 1e-3, 0.0), 1.0);
    append_jump(path, Vec3(0.0, 0.0, 0.0));
    const auto lit = [](const std::vector<PathCorner>& corners) {
        std::vector<bool> flags;
        for (std::size_t i = 1; i < corners.size(); ++i) {
            flags.push_back(corners[i].lit);
        }
        return flags;
    };
    const double way_back = 1e-3 + 0.5e-3;
    EXPECT_EQ(lit(corners_at(path, way_back).done), (std::vector<bool>{true, false}));
    EXPECT_EQ(lit(corners_at(path, way_back).to_come), (std::vector<bool>{false, false, true, false}));
    EXPECT_EQ(lit(corners_at(path, 1.0).done), (std::vector<bool>{true, false, false, true, false}));
    // What was run is still known after the path was changed under way.
    const ScanPath rest = path_from(path, way_back);
    EXPECT_EQ(lit(corners_at(rest, 1.0).done), (std::vector<bool>{true, false, false, false, true, false}));
}

TEST(ScanPath, jump_takes_no_time) {
    ScanPath path = hook();
    const double end = path_end_time(path);
    append_jump(path, Vec3(0.0, 0.0, 0.0));
    EXPECT_EQ(path_end_time(path), end);
    append_line(path, Vec3(1e-3, 0.0, 0.0), 2.0);
    EXPECT_EQ(beam_at(path, end).position, Vec3::Zero());
    EXPECT_TRUE(beam_at(path, end).on);
}

TEST(ScanPath, path_taken_up_under_way_begins_bitwise_where_and_when_the_beam_is) {
    const ScanPath path = hook();
    for (const double time : {1.7e-4, 1.0333e-3, 1.2e-3, 2.123456789e-3}) {
        const ScanPath rest = path_from(path, time);
        const BeamPosition now = beam_at(path, time);
        const BeamPosition again = beam_at(rest, time);
        EXPECT_EQ(rest.start_time, time);
        EXPECT_EQ(again.position, now.position);
        EXPECT_EQ(again.on, now.on);
        EXPECT_NEAR(path_end_time(rest), path_end_time(path), 1e-15);
        EXPECT_EQ(path_end(rest), path_end(path));
        EXPECT_EQ(corners_at(rest, time).done, corners_at(path, time).done);
    }
}

TEST(ScanPath, path_not_yet_begun_or_over_can_be_taken_up) {
    const ScanPath path = hook();
    EXPECT_EQ(path_from(path, 0.0), path);
    ScanPath over = path_from(path, 1.0);
    EXPECT_EQ(over.start, path_end(path));
    EXPECT_EQ(over.start_time, 1.0);
    EXPECT_TRUE(over.segments.empty());
    append_line(over, Vec3::Zero(), 1.0);
    EXPECT_EQ(beam_at(over, 1.0).position, path_end(path));
}

TEST(ScanPath, cut_path_leaves_the_beam_where_it_is_and_dark) {
    const ScanPath path = hook();
    const double time = 6.1e-4;
    const ScanPath cut = path_cut_at(path, time);
    EXPECT_EQ(beam_at(cut, time).position, beam_at(path, time).position);
    EXPECT_EQ(beam_at(cut, 1.0).position, beam_at(path, time).position);
    EXPECT_FALSE(beam_at(cut, time).on);
}

TEST(ScanPath, new_speed_holds_for_lines_with_light_from_now_on) {
    const ScanPath path = hook();
    const double time = 6e-4; // half of the first line is run
    const ScanPath faster = with_speed_from(path, time, 2.0);
    EXPECT_EQ(beam_at(faster, time).position, beam_at(path, time).position);
    EXPECT_NEAR(path_end_time(faster), time + 0.5e-3 / 2.0 + 5e-4 + 2e-3 / 2.0, 1e-15);
    EXPECT_THROW(with_speed_from(path, time, 0.0), PathError);
}

TEST(ScanPath, new_power_holds_for_segments_with_light_from_now_on) {
    const ScanPath path = hook();
    const ScanPath stronger = with_power_from(path, 6e-4, 300.0);
    EXPECT_EQ(beam_at(stronger, 7e-4).power, 300.0);
    EXPECT_FALSE(beam_at(stronger, 1.3e-3).power);
    EXPECT_EQ(beam_at(stronger, 3e-3).power, 300.0);
    EXPECT_FALSE(beam_at(with_power_from(path, 6e-4, std::nullopt), 3e-3).power);
}

TEST(ScanPath, appended_path_is_joined_by_a_jump) {
    ScanPath path = hook();
    const double end = path_end_time(path);
    append_path(path, hook());
    EXPECT_NEAR(path_end_time(path), 2.0 * end - 1e-4, 1e-15);
    EXPECT_EQ(beam_at(path, end).position, hook().start);
}

TEST(ScanPath, what_cannot_be_run_is_refused) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    ScanPath path;
    EXPECT_THROW(append_line(path, Vec3::Zero(), 1.0), PathError);
    EXPECT_THROW(append_line(path, Vec3::UnitX(), 0.0), PathError);
    EXPECT_THROW(append_line(path, Vec3::UnitX(), -1.0), PathError);
    EXPECT_THROW(append_line(path, Vec3(nan, 0.0, 0.0), 1.0), PathError);
    EXPECT_THROW(append_line(path, Vec3::UnitX(), 1.0, -5.0), PathError);
    EXPECT_THROW(append_dwell(path, 0.0), PathError);
    EXPECT_THROW(append_dwell(path, nan), PathError);
    EXPECT_THROW(append_jump(path, Vec3(nan, 0.0, 0.0)), PathError);
    EXPECT_TRUE(path.segments.empty());

    path = hook();
    path.segments[2].speed = -1.0;
    try {
        check_path(path);
        FAIL();
    } catch (const PathError& error) {
        EXPECT_NE(std::string(error.what()).find("segment 3"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace meltscope
