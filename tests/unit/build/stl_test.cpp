#include "meltscope/build/stl.hpp"

#include "mesh_samples.hpp"

#include "meltscope/constants.hpp"

#include <gtest/gtest.h>

namespace meltscope {
namespace {

std::string message_on_stl(std::string_view bytes, double scale = 1.0) {
    try {
        parse_stl(bytes, "part.stl", scale);
    } catch (const GeometryError& error) {
        return error.what();
    }
    return "";
}

bool says(const std::string& message, std::string_view part) {
    return message.starts_with("part.stl") && message.find(part) != std::string::npos;
}

const Solid block = block_mesh(Vec3(0, 0, 0), Vec3(1, 2, 3));

TEST(Stl, binary_and_ascii_give_the_same_closed_mesh) {
    const Solid binary = parse_stl(binary_stl(block), "part.stl");
    const Solid ascii = parse_stl(ascii_stl(block), "part.stl");
    EXPECT_EQ(binary.points.size(), 8u);
    EXPECT_EQ(binary.triangles.size(), 12u);
    EXPECT_EQ(ascii.points, binary.points);
    EXPECT_EQ(ascii.triangles, binary.triangles);
    EXPECT_DOUBLE_EQ(volume(binary), 6.0);
    EXPECT_NO_THROW(check_closed(binary));
}

TEST(Stl, scale_turns_the_files_unit_into_metres) {
    EXPECT_NEAR(volume(parse_stl(binary_stl(block), "part.stl", 1e-3)), 6e-9, 1e-18);
    EXPECT_TRUE(says(message_on_stl(binary_stl(block), 0.0), "scale"));
}

TEST(Stl, mesh_that_is_inside_out_is_turned) {
    Solid turned = block;
    for (auto& triangle : turned.triangles) {
        std::swap(triangle[0], triangle[1]);
    }
    EXPECT_DOUBLE_EQ(volume(parse_stl(binary_stl(turned), "part.stl")), 6.0);
}

TEST(Stl, volume_of_a_ball_mesh_nears_that_of_the_ball_at_second_order) {
    const double ball = 4.0 / 3.0 * constants::pi;
    const double coarse = ball - volume(ball_mesh(Vec3(1, 2, 3), 1.0, 3));
    const double fine = ball - volume(ball_mesh(Vec3(1, 2, 3), 1.0, 4));
    EXPECT_GT(fine, 0.0);
    EXPECT_NEAR(coarse / fine, 4.0, 0.1);
}

TEST(Stl, open_mesh_is_refused_with_the_edge) {
    Solid open = block;
    open.triangles.pop_back();
    EXPECT_TRUE(says(message_on_stl(binary_stl(open)), "not closed: the edge from ("));
}

TEST(Stl, triangle_that_runs_the_wrong_way_is_refused) {
    Solid twisted = block;
    std::swap(twisted.triangles[3][0], twisted.triangles[3][1]);
    EXPECT_TRUE(says(message_on_stl(binary_stl(twisted)), "not oriented"));
}

TEST(Stl, edge_of_more_than_two_triangles_is_refused) {
    Solid folded = block;
    folded.triangles.push_back(block.triangles[0]);
    folded.triangles.push_back({block.triangles[0][0], block.triangles[0][2], block.triangles[0][1]});
    EXPECT_TRUE(says(message_on_stl(binary_stl(folded)), "belongs to 4 triangles"));
}

TEST(Stl, triangle_without_area_is_refused) {
    Solid degenerate = block;
    degenerate.triangles.push_back({0, 1, 1});
    EXPECT_TRUE(says(message_on_stl(binary_stl(degenerate)), "degenerate"));
}

TEST(Stl, file_cut_short_or_too_long_is_refused) {
    const std::string bytes = binary_stl(block);
    EXPECT_TRUE(says(message_on_stl(bytes.substr(0, bytes.size() - 7)), "cut short"));
    EXPECT_TRUE(says(message_on_stl(bytes + std::string(3, '\1')), "too long"));
    EXPECT_TRUE(says(message_on_stl(bytes.substr(0, 30)), "too few"));
    EXPECT_TRUE(says(message_on_stl(""), "too few"));
    const std::string text = ascii_stl(block);
    EXPECT_TRUE(says(message_on_stl(text.substr(0, text.size() / 2)), "part.stl:"));
    EXPECT_TRUE(says(message_on_stl(text.substr(0, text.find("endsolid"))), "cut short"));
}

TEST(Stl, ascii_error_names_the_line) {
    std::string text = ascii_stl(block);
    text.replace(text.find("vertex"), 6, "vortex");
    EXPECT_EQ(message_on_stl(text), "part.stl:4: \"vertex\" was to come, not \"vortex\"");
    text = ascii_stl(block);
    text.replace(text.find("vertex 0"), 8, "vertex x");
    EXPECT_TRUE(says(message_on_stl(text), "part.stl:4: a number was to come"));
}

TEST(Stl, binary_file_that_begins_with_solid_is_read) {
    std::string bytes = binary_stl(block);
    bytes.replace(0, 5, "solid");
    EXPECT_EQ(message_on_stl(bytes), "");
}

TEST(Stl, coordinates_that_are_not_finite_are_refused) {
    std::string bytes = binary_stl(block);
    bytes.replace(84 + 12, 4, std::string("\x00\x00\xc0\x7f", 4));
    EXPECT_TRUE(says(message_on_stl(bytes), "triangle 1 has a coordinate that is not finite"));
}

TEST(Stl, mesh_without_triangles_is_refused) {
    EXPECT_TRUE(says(message_on_stl("solid nothing\nendsolid nothing\n"), "no triangles"));
    EXPECT_TRUE(says(message_on_stl(binary_stl(Solid{})), "no triangles"));
}

TEST(Stl, every_single_damaged_byte_is_read_or_refused_but_never_crashes) {
    const std::string bytes = binary_stl(block);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string damaged = bytes;
        damaged[i] = static_cast<char>(damaged[i] ^ 0x41);
        const std::string message = message_on_stl(damaged);
        EXPECT_TRUE(message.empty() || message.starts_with("part.stl")) << i;
    }
}

} // namespace
} // namespace meltscope
