#include "meltscope/beam/pattern.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

namespace meltscope {
namespace {

using Kind = PathSegment::Kind;

RasterSpec square(double angle) {
    RasterSpec spec;
    spec.min = {1e-3, 2e-3};
    spec.max = {2e-3, 3e-3};
    spec.z = 5e-5;
    spec.hatch = 1e-4;
    spec.angle = angle;
    spec.speed = 0.8;
    return spec;
}

/// Begin and end of every line with light.
std::vector<std::pair<Vec3, Vec3>> lit_lines(const ScanPath& path) {
    std::vector<std::pair<Vec3, Vec3>> lines;
    Vec3 from = path.start;
    for (const PathSegment& segment : path.segments) {
        if (segment.laser_on && segment.kind == Kind::line) {
            lines.emplace_back(from, segment.end);
        }
        from = segment.end;
    }
    return lines;
}

bool on_edge(const RasterSpec& spec, const Vec3& point) {
    const bool inside = point.x() >= spec.min.x() && point.x() <= spec.max.x() && point.y() >= spec.min.y() &&
                        point.y() <= spec.max.y();
    return inside && (point.x() == spec.min.x() || point.x() == spec.max.x() || point.y() == spec.min.y() ||
                      point.y() == spec.max.y());
}

TEST(Pattern, raster_along_x_lays_level_lines_a_hatch_apart) {
    const auto lines = lit_lines(make_raster(square(0.0)));
    ASSERT_EQ(lines.size(), 10u);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const auto& [from, to] = lines[i];
        EXPECT_NEAR(from.y(), 2e-3 + (static_cast<double>(i) + 0.5) * 1e-4, 1e-15);
        EXPECT_EQ(from.y(), to.y());
        EXPECT_EQ(from.z(), 5e-5);
        EXPECT_EQ(from.x(), i % 2 == 0 ? 1e-3 : 2e-3);
        EXPECT_EQ(to.x(), i % 2 == 0 ? 2e-3 : 1e-3);
    }
}

TEST(Pattern, one_way_raster_runs_every_line_the_same_way) {
    RasterSpec spec = square(0.3);
    spec.bidirectional = false;
    for (const auto& [from, to] : lit_lines(make_raster(spec))) {
        EXPECT_GT((to - from).dot(Vec3(std::cos(0.3), std::sin(0.3), 0.0)), 0.0);
    }
}

TEST(Pattern, turned_lines_end_exactly_on_the_edges_and_cover_the_area) {
    for (const double angle : {0.1, 0.7, 1.1693705988362009, 1.5707963267948966, 2.5, -1.0, 40.0}) {
        RasterSpec spec = square(angle);
        spec.hatch = 1e-5;
        double length = 0.0;
        for (const auto& [from, to] : lit_lines(make_raster(spec))) {
            EXPECT_TRUE(on_edge(spec, from)) << angle;
            EXPECT_TRUE(on_edge(spec, to)) << angle;
            EXPECT_NEAR(std::abs((to - from).normalized().dot(Vec3(-std::sin(angle), std::cos(angle), 0.0))),
                        0.0, 1e-6);
            length += (to - from).norm();
        }
        EXPECT_NEAR(length * spec.hatch, 1e-6, 2e-8) << angle;
    }
}

TEST(Pattern, turn_time_passes_dark_between_lines) {
    RasterSpec spec = square(0.0);
    spec.turn_time = 2e-4;
    spec.start_time = 1.0;
    const ScanPath path = make_raster(spec);
    EXPECT_EQ(path.start_time, 1.0);
    EXPECT_NEAR(path_end_time(path), 1.0 + 10 * 1e-3 / 0.8 + 9 * 2e-4, 1e-12);
    EXPECT_FALSE(beam_at(path, 1.0 + 1e-3 / 0.8 + 1e-4).on);
}

TEST(Pattern, hatch_wider_than_the_rectangle_gives_one_line_in_the_middle) {
    RasterSpec spec = square(0.0);
    spec.hatch = 1.0;
    const auto lines = lit_lines(make_raster(spec));
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_DOUBLE_EQ(lines[0].first.y(), 2.5e-3);
}

TEST(Pattern, islands_cover_the_rectangle_once_in_an_order_set_by_the_seed) {
    IslandSpec spec;
    spec.raster = square(0.0);
    spec.raster.max = {2.25e-3, 3e-3}; // the last column is cut
    spec.raster.hatch = 2.5e-5;
    spec.island_size = 5e-4;
    const ScanPath path = make_island(spec);
    double length = 0.0;
    std::set<std::pair<int, int>> met;
    for (const auto& [from, to] : lit_lines(path)) {
        length += (to - from).norm();
        const Vec3 middle = 0.5 * (from + to);
        const std::pair<int, int> island{static_cast<int>((middle.x() - 1e-3) / 5e-4),
                                         static_cast<int>((middle.y() - 2e-3) / 5e-4)};
        met.insert(island);
        const bool turned = (island.first + island.second) % 2 == 1;
        EXPECT_EQ(turned ? to.x() - from.x() : to.y() - from.y(), 0.0);
    }
    EXPECT_EQ(met.size(), 6u);
    EXPECT_NEAR(length * spec.raster.hatch, 1.25e-6, 1e-11);

    EXPECT_EQ(make_island(spec), path);
    IslandSpec other = spec;
    other.seed = 2;
    EXPECT_NE(make_island(other), path);
    EXPECT_NEAR(path_end_time(make_island(other)), path_end_time(path), 1e-12);
}

TEST(Pattern, layers_rise_and_turn) {
    LayerSpec layers;
    layers.count = 3;
    layers.thickness = 4e-5;
    layers.pause = 1e-2;
    const auto one = lit_lines(make_raster(square(0.0))).size();
    const ScanPath path = make_raster_layers(square(0.0), layers);
    const auto lines = lit_lines(path);
    EXPECT_EQ(lines.front().first.z(), 5e-5);
    EXPECT_DOUBLE_EQ(lines.back().first.z(), 13e-5);
    const Vec3 second = (lines[one].second - lines[one].first).normalized();
    EXPECT_NEAR(second.x(), std::cos(67.0 * 3.14159265358979323846 / 180.0), 1e-9);
    EXPECT_FALSE(beam_at(path, path_end_time(make_raster(square(0.0))) + 5e-3).on);
    EXPECT_NO_THROW(check_path(path));
}

TEST(Pattern, what_cannot_be_run_is_refused) {
    const auto refused = [](auto change) {
        RasterSpec spec = square(0.0);
        change(spec);
        EXPECT_THROW(make_raster(spec), PathError);
    };
    refused([](RasterSpec& spec) { spec.hatch = 0.0; });
    refused([](RasterSpec& spec) { spec.hatch = 1e-12; });
    refused([](RasterSpec& spec) { spec.speed = -1.0; });
    refused([](RasterSpec& spec) { spec.max.x() = spec.min.x(); });
    refused([](RasterSpec& spec) { spec.angle = HUGE_VAL; });
    refused([](RasterSpec& spec) { spec.turn_time = -1.0; });
    IslandSpec islands;
    islands.raster = square(0.0);
    EXPECT_THROW(make_island(islands), PathError) << "no island size";
    LayerSpec layers;
    layers.count = 0;
    EXPECT_THROW(make_raster_layers(square(0.0), layers), PathError);
}

} // namespace
} // namespace meltscope
