#include "scratch.hpp"
#include "viz/display.hpp"
#include "viz/process.hpp"

#include <chrono>
#include <csignal>
#include <gtest/gtest.h>

namespace meltscope::viz {
namespace {

TEST(Child, output_comes_up_to_the_character_waited_for) {
    Child child({"/bin/sh", "-c", "printf '42\\nmore' >&3; sleep 20", "sh", Child::pipe_word});
    EXPECT_EQ(child.read_until('\n', std::chrono::seconds(60)), "42\n");
}

TEST(Child, a_silent_child_costs_no_more_than_the_timeout) {
    Child child({"/bin/sleep", "20"});
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(child.read_until('\n', std::chrono::milliseconds(100)), "");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST(Child, it_is_gone_when_its_owner_is) {
    pid_t id = -1;
    {
        Child child({"/bin/sleep", "20"});
        id = child.id();
        EXPECT_EQ(kill(id, 0), 0);
    }
    EXPECT_EQ(kill(id, 0), -1);
}

TEST(Child, exit_code_and_errors_of_a_program_are_seen) {
    Child child({"/bin/sh", "-c", "echo sad >&2; exit 3"});
    EXPECT_EQ(child.read_all(), "sad\n");
    EXPECT_EQ(child.wait(), 3);
}

TEST(Display, an_unusable_display_is_refused_before_vtk_sees_it) {
    const test::ScopedVariable no_server("DISPLAY", ":987");
    EXPECT_THROW(Display{Backend::x11}, VizError);
}

TEST(Display, without_display_and_xvfb_the_reason_is_told) {
    const test::ScopedVariable no_display("DISPLAY", nullptr);
    const test::ScopedVariable no_programs("PATH", "/nonexistent");
    try {
        Display display(Backend::automatic);
        FAIL() << "a display out of nothing";
    } catch (const VizError& error) {
        EXPECT_NE(std::string(error.what()).find("xvfb"), std::string::npos) << error.what();
    }
}

TEST(Display, automatic_falls_back_to_a_private_server) {
    if (!find_program("Xvfb")) {
        GTEST_SKIP() << "no Xvfb";
    }
    const test::ScopedVariable no_server("DISPLAY", ":987");
    const Display display(Backend::automatic);
    EXPECT_EQ(display.backend(), Backend::xvfb);
    EXPECT_NE(display.x_display(), nullptr);
    EXPECT_FALSE(display.lost());
}

TEST(Options, names_of_backends_go_both_ways) {
    for (const Backend backend :
         {Backend::automatic, Backend::x11, Backend::xvfb, Backend::egl, Backend::osmesa, Backend::none}) {
        EXPECT_EQ(backend_from_name(backend_name(backend)), backend);
    }
    EXPECT_THROW(backend_from_name("glut"), VizError);
}

TEST(Options, impossible_pictures_are_refused) {
    const auto with = [](auto change) {
        RenderOptions options;
        change(options);
        return options;
    };
    EXPECT_NO_THROW(validate(RenderOptions{}));
    EXPECT_THROW(validate(with([](auto& o) { o.views = {"overveiw"}; })), VizError);
    EXPECT_THROW(validate(with([](auto& o) { o.field = "pressure"; })), VizError);
    EXPECT_THROW(validate(with([](auto& o) { o.colormap = "jet"; })), VizError);
    EXPECT_THROW(validate(with([](auto& o) { o.size = {0, 720}; })), VizError);
    EXPECT_THROW(validate(with([](auto& o) { o.color_range = {{2000.0, 300.0}}; })), VizError);
}

} // namespace
} // namespace meltscope::viz
