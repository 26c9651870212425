#include "meltscope/build/ball_file.hpp"

#include <gtest/gtest.h>

#include <string>

namespace meltscope {
namespace {

std::string message_on_balls(std::string_view text, const std::optional<Box>& domain = {}) {
    try {
        parse_ball_text(text, "bed.csv", domain);
    } catch (const GeometryError& error) {
        return error.what();
    }
    return "";
}

TEST(BallFile, rows_become_balls_with_or_without_a_header) {
    const std::string rows = "1e-5, 2e-5, 3e-5, 1.5e-5\r\n\n-1e-5,0,+0.5,2\n";
    for (const std::string head : {"", "x,y,z,r\n", "X (m), Y (m), Z (m), radius (m)\n"}) {
        const Balls balls = parse_ball_text(head + rows, "bed.csv");
        ASSERT_EQ(balls.balls.size(), 2u);
        EXPECT_EQ(balls.balls[0].center, Vec3(1e-5, 2e-5, 3e-5));
        EXPECT_EQ(balls.balls[0].radius, 1.5e-5);
        EXPECT_EQ(balls.balls[1].center, Vec3(-1e-5, 0.0, 0.5));
    }
}

TEST(BallFile, what_is_wrong_is_named_with_its_line) {
    EXPECT_EQ(message_on_balls("x,y,z,r\n0,0,0,1\n0,0,0,-1e-5\n"),
              "bed.csv:3: the radius must be above zero, not -1e-05 m");
    EXPECT_EQ(message_on_balls("0,0,0\n"), "bed.csv:1: a row has 4 columns (x,y,z,r), this one has 3");
    EXPECT_EQ(message_on_balls("0,0,0,1\n0,zero,0,1\n"),
              "bed.csv:2: y must be a finite number, not \"zero\"");
    EXPECT_EQ(message_on_balls("0,0,inf,1\n"), "bed.csv:1: z must be a finite number, not \"inf\"");
    EXPECT_NE(message_on_balls("x,y,z,d\n0,0,0,1\n").find("bed.csv:1: column 4 of the header must be r"),
              std::string::npos);
    EXPECT_NE(message_on_balls("0,0,0,1\nx,y,z,r\n").find("bed.csv:2:"), std::string::npos);
    EXPECT_NE(message_on_balls("x,y,z,r\n").find("no ball"), std::string::npos);
    EXPECT_NE(message_on_balls("").find("no ball"), std::string::npos);
    EXPECT_THROW(read_ball_file("/no/such/file"), GeometryError);
}

TEST(BallFile, ball_wholly_outside_the_domain_is_refused) {
    const Box domain{Vec3(0, 0, 0), Vec3(1, 1, 1)};
    EXPECT_EQ(message_on_balls("1.2,0.5,0.5,0.3\n", domain), "") << "it reaches into the domain";
    EXPECT_NE(message_on_balls("0.5,0.5,0.5,0.3\n1.2,0.5,0.5,0.1\n", domain).find("bed.csv:2: the ball at"),
              std::string::npos);
    EXPECT_NE(message_on_balls("1.1,1.1,1.1,0.15\n", domain), "") << "near a corner, but beyond it";
}

} // namespace
} // namespace meltscope
