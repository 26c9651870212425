#include "meltscope/beam/path_file.hpp"

#include <gtest/gtest.h>

#include <string>

namespace meltscope {
namespace {

constexpr PathFileFormat foam = PathFileFormat::additivefoam;
constexpr PathFileFormat thesis = PathFileFormat::threedthesis;

std::string message_of(std::string_view text, PathFileFormat format, std::optional<double> power = {}) {
    try {
        parse_path_text(text, "scan.txt", format, power);
    } catch (const PathError& error) {
        return error.what();
    }
    return "";
}

TEST(PathFile, rows_of_metres_and_watts_become_segments) {
    const ScanPath path = parse_path_text("Mode\tX(m)\tY(m)\tZ(m)\tPower(W)\ttParam\n"
                                          "1 0.001 0.002 0 0 0\r\n"
                                          "0 0.003 0.002 0 195 0.8\n"
                                          "\n"
                                          "0 0.003 0.0021 0 0 2.0\n"
                                          "1 0.003 0.0021 0 50 1e-3",
                                          "scan.txt", foam);
    EXPECT_EQ(path.start, Vec3(0.001, 0.002, 0.0));
    ASSERT_EQ(path.segments.size(), 3u);
    EXPECT_EQ(path.segments[0].power, 195.0);
    EXPECT_EQ(path.segments[0].speed, 0.8);
    EXPECT_TRUE(path.segments[0].laser_on);
    EXPECT_FALSE(path.segments[1].laser_on);
    EXPECT_EQ(path.segments[2].kind, PathSegment::Kind::dwell);
    EXPECT_EQ(path.segments[2].power, 50.0);
    EXPECT_DOUBLE_EQ(path_end_time(path), 0.002 / 0.8 + 0.0001 / 2.0 + 1e-3);
}

TEST(PathFile, first_spot_with_a_duration_is_a_dwell_at_the_start) {
    const ScanPath path = parse_path_text("Mode X Y Z Power Param\n1 1 2 3 0 0.5\n0 2 2 3 10 1\n", "f", foam);
    EXPECT_EQ(path.start, Vec3(1, 2, 3));
    EXPECT_FALSE(beam_at(path, 0.25).on);
    EXPECT_EQ(beam_at(path, 0.25).position, Vec3(1, 2, 3));
    EXPECT_EQ(beam_at(path, 1.0).power, 10.0);
}

TEST(PathFile, later_spots_are_reached_at_once) {
    const ScanPath path =
        parse_path_text("Mode X Y Z Power Param\n1 0 0 0 9 1\n1 5 0 0 9 1\n1 0 5 0 9 1\n", "f", foam);
    EXPECT_EQ(path_end_time(path), 3.0);
    EXPECT_EQ(beam_at(path, 1.5).position, Vec3(5, 0, 0));
    EXPECT_TRUE(beam_at(path, 1.0).on);
    EXPECT_EQ(beam_at(path, 2.0).position, Vec3(0, 5, 0));
}

TEST(PathFile, millimetres_and_power_factors_of_3dthesis_are_converted) {
    const ScanPath path = parse_path_text("Mode\tX(mm)\tY(mm)\tZ(mm)\tPmod\ttParam\n"
                                          "1\t1.5\t0\t0\t0\t0\n"
                                          "0\t3.5\t0\t0\t1\t0.5\n"
                                          "0\t3.5\t1\t0\t0.25\t0.5\n",
                                          "scan.txt", thesis, 200.0);
    EXPECT_EQ(path.start, Vec3(0.0015, 0.0, 0.0));
    EXPECT_DOUBLE_EQ(path_end_time(path), 0.003 / 0.5);
    EXPECT_FALSE(path.segments[0].power) << "a factor of one leaves the laser's own power in force";
    EXPECT_EQ(path.segments[1].power, 50.0);
}

TEST(PathFile, power_factor_without_a_laser_power_is_refused) {
    const std::string text = "Mode X Y Z Pmod Param\n1 0 0 0 0 0\n0 1 0 0 0.5 1\n";
    EXPECT_NE(message_of(text, thesis).find("scan.txt:3:"), std::string::npos);
    EXPECT_EQ(message_of(text, thesis, 100.0), "");
}

TEST(PathFile, message_names_line_column_and_reason) {
    const std::string head = "Mode X Y Z Power Param\n1 0 0 0 0 0\n";
    EXPECT_EQ(message_of(head + "2 0 0 0 0 0\n", foam),
              "scan.txt:3:1: Mode must be 0 (line) or 1 (stay), not 2");
    EXPECT_NE(message_of(head + "0 1 0 0 195\n", foam).find("scan.txt:3:1: a row has 6 columns"),
              std::string::npos);
    EXPECT_NE(message_of(head + "0 1 0 0 195 1 7\n", foam).find("scan.txt:3:15: a row has 6 columns"),
              std::string::npos);
    EXPECT_EQ(message_of(head + "0 1 zero 0 195 1\n", foam),
              "scan.txt:3:5: Y must be a number, not \"zero\"");
    EXPECT_NE(message_of(head + "0 1 nan 0 195 1\n", foam).find("3:5: Y must be finite"), std::string::npos);
    EXPECT_NE(message_of(head + "0 1 0 0 -195 1\n", foam).find("3:9: Power"), std::string::npos);
    EXPECT_NE(message_of(head + "0 1 0 0 195 0\n", foam).find("3:13: the speed of a line"),
              std::string::npos);
    EXPECT_NE(message_of(head + "1 1 0 0 195 -1\n", foam).find("3:13: the time of a stay"),
              std::string::npos);
    EXPECT_NE(message_of(head + "0 0 0 0 195 1\n", foam).find("scan.txt:3:1: a line must have a length"),
              std::string::npos);
}

TEST(PathFile, header_with_the_other_formats_units_is_refused_by_name) {
    const auto complaint = [](const char* header, PathFileFormat format) -> std::string {
        try {
            parse_path_text(std::string(header) + "\n1 0 0 0 0 0\n0 1 0 0 1 1\n", "p.txt", format, 100.0);
        } catch (const PathError& error) {
            return error.what();
        }
        return "";
    };
    const char* metres = "Mode X(m) Y(m) Z(m) Power(W) tParam";
    const char* millimetres = "Mode X(mm) Y(mm) Z(mm) Pmod tParam";
    EXPECT_EQ(complaint(metres, PathFileFormat::additivefoam), "");
    EXPECT_EQ(complaint(millimetres, PathFileFormat::threedthesis), "");
    EXPECT_NE(complaint(millimetres, PathFileFormat::additivefoam).find("p.txt:1:6: X(mm)"),
              std::string::npos);
    EXPECT_NE(complaint(metres, PathFileFormat::threedthesis).find("p.txt:1:6: X(m)"), std::string::npos);
}

TEST(PathFile, file_without_header_or_rows_is_refused) {
    EXPECT_NE(message_of("1 0 0 0 0 0\n0 1 0 0 1 1\n", foam).find("scan.txt:1:1: the first line"),
              std::string::npos);
    EXPECT_NE(message_of("", foam).find("empty"), std::string::npos);
    EXPECT_NE(message_of("Mode X Y Z Power Param\n\n", foam).find("no row"), std::string::npos);
    EXPECT_THROW(read_path_file("/no/such/file", foam), PathError);
    EXPECT_THROW(read_path_file("/", foam), PathError);
}

TEST(PathFile, huge_numbers_do_not_slip_through) {
    EXPECT_NE(message_of("Mode X Y Z Power Param\n1 0 0 0 0 1e308\n1 0 0 0 0 1e308\n", foam), "");
    EXPECT_NE(message_of("Mode X Y Z Power Param\n0 1e300 0 0 1 1e-300\n", foam), "");
}

} // namespace
} // namespace meltscope
