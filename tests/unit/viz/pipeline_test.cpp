#include "scratch.hpp"
#include "synthetic.hpp"
#include "viz/frame_renderer.hpp"
#include "viz/pipeline.hpp"
#include "viz/process.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <mutex>
#include <sstream>
#include <thread>
#include <unistd.h>

namespace meltscope::viz {
namespace {

bool can_render() {
    return find_program("Xvfb").has_value();
}

class PipelineTest : public testing::Test {
  protected:
    PipelineTest() {
        files.run_dir = scratch.path();
        render.run_dir = scratch.path();
        render.size = {320, 180};
        plate.count = {61, 21, 13};
        plate.spacing = 25e-6;
    }

    Pipeline::Report collect() {
        return [this](const std::string& words) {
            const std::lock_guard lock(mutex);
            warnings.push_back(words);
        };
    }

    std::shared_ptr<const Snapshot> at(double time) { return test::make_snapshot(plate, time); }

    test::ScratchFolder scratch;
    FileOptions files;
    RenderOptions render;
    test::SyntheticPlate plate;
    std::mutex mutex;
    std::vector<std::string> warnings;
};

/// Children of this process that run Xvfb.
std::vector<pid_t> own_servers() {
    std::vector<pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::ifstream stream(entry.path() / "stat");
        std::string id;
        std::string name;
        std::string state;
        pid_t parent = 0;
        if (stream >> id >> name >> state >> parent && name == "(Xvfb)" && parent == getpid() &&
            state != "Z") {
            found.push_back(std::stoi(id));
        }
    }
    return found;
}

TEST_F(PipelineTest, pictures_and_files_are_all_there_at_the_end) {
    if (!can_render()) {
        GTEST_SKIP() << "no Xvfb";
    }
    std::vector<std::string> notes;
    render.views = {"overview", "top"};
    Pipeline pipeline(files, render, Backend::xvfb, {}, collect(),
                      [&](const std::string& words) { notes.push_back(words); });
    for (int i = 0; i < 4; ++i) {
        pipeline.submit(at(1e-4 * i), true, i % 2 == 0);
    }
    pipeline.finish();
    const PipelineStats stats = pipeline.stats();
    EXPECT_EQ(stats.frames, 8);
    EXPECT_EQ(stats.files, 6);
    EXPECT_EQ(stats.failure, "");
    EXPECT_EQ(stats.backend, Backend::xvfb);
    EXPECT_NE(stats.window_class.find("RenderWindow"), std::string::npos);
    EXPECT_FALSE(stats.renderer.empty());
    EXPECT_EQ(notes.size(), 1U);
    EXPECT_TRUE(warnings.empty()) << warnings.front();
    for (int i = 0; i < 4; ++i) {
        for (const char* view : {"overview", "top"}) {
            std::ostringstream name;
            name << view << "_00000" << i << ".png";
            const auto path = scratch.path() / "frames" / name.str();
            ASSERT_TRUE(std::filesystem::exists(path)) << path;
            EXPECT_EQ(png_time(path), 1e-4 * i);
        }
    }
    EXPECT_TRUE(own_servers().empty()) << "the private server outlived its run";
}

TEST_F(PipelineTest, without_display_files_are_written_and_one_warning_told) {
    const test::ScopedVariable no_display("DISPLAY", nullptr);
    const test::ScopedVariable no_programs("PATH", "/nonexistent");
    Pipeline pipeline(files, render, Backend::automatic, {}, collect());
    for (int i = 0; i < 3; ++i) {
        pipeline.submit(at(1e-4 * i), true, true);
    }
    pipeline.finish();
    EXPECT_EQ(pipeline.stats().frames, 0);
    EXPECT_EQ(pipeline.stats().files, 9);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("xvfb"), std::string::npos) << warnings[0];
    EXPECT_NE(pipeline.stats().failure, "");
}

TEST_F(PipelineTest, a_full_queue_makes_the_solver_wait_and_counts_it) {
    if (!can_render()) {
        GTEST_SKIP() << "no Xvfb";
    }
    // The note holds the viz thread at the first picture until somebody waits.
    std::atomic<bool> go = false;
    Pipeline pipeline(files, render, Backend::xvfb, {BacklogPolicy::OnFull::wait, 1}, collect(),
                      [&](const std::string&) { go.wait(false); });
    pipeline.submit(at(0.0), true, false);
    std::thread solver([&] { pipeline.submit(at(1e-4), true, true); });
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (pipeline.stats().waits == 0 && std::chrono::steady_clock::now() < patience) {
        std::this_thread::yield();
    }
    EXPECT_EQ(pipeline.stats().files, 0);
    go = true;
    go.notify_all();
    solver.join();
    pipeline.finish();
    const PipelineStats stats = pipeline.stats();
    EXPECT_EQ(stats.waits, 1);
    EXPECT_GT(stats.wait_seconds, 0.0);
    EXPECT_EQ(stats.drops, 0);
    EXPECT_EQ(stats.frames, 2);
    EXPECT_EQ(stats.files, 3);
    EXPECT_TRUE(warnings.empty());
}

TEST_F(PipelineTest, a_full_queue_drops_pictures_but_no_files) {
    // The note holds the viz thread at the first picture until the queue has been overrun.
    if (!can_render()) {
        GTEST_SKIP() << "no Xvfb";
    }
    std::atomic<bool> go = false;
    Pipeline pipeline(files, render, Backend::xvfb, {BacklogPolicy::OnFull::drop, 2}, collect(),
                      [&](const std::string&) { go.wait(false); });
    pipeline.submit(at(0.0), true, false);
    pipeline.submit(at(1e-4), true, false);
    for (int i = 2; i < 6; ++i) {
        pipeline.submit(at(1e-4 * i), true, false);
    }
    EXPECT_EQ(pipeline.stats().drops, 4);
    go = true;
    go.notify_all();
    pipeline.submit(at(1e-3), false, true);
    pipeline.finish();
    EXPECT_EQ(pipeline.stats().frames, 2);
    EXPECT_EQ(pipeline.stats().files, 3);
    EXPECT_TRUE(warnings.empty());
}

TEST_F(PipelineTest, an_unwritable_folder_is_told_once_and_stops_nothing) {
    // A plain file where the folder should be: no permission is asked of root either.
    files.run_dir = scratch.path() / "file";
    render.run_dir = files.run_dir;
    std::ofstream(files.run_dir) << "in the way\n";
    Pipeline pipeline(files, render, can_render() ? Backend::xvfb : Backend::none, {}, collect());
    for (int i = 0; i < 3; ++i) {
        pipeline.submit(at(1e-4 * i), true, true);
    }
    pipeline.finish();
    EXPECT_EQ(pipeline.stats().frames, 0);
    EXPECT_EQ(pipeline.stats().files, 0);
    EXPECT_EQ(warnings.size(), 2U) << "one for the files, one for the pictures";
}

TEST_F(PipelineTest, a_folder_removed_during_the_run_is_made_again) {
    Pipeline pipeline(files, render, Backend::none, {BacklogPolicy::OnFull::wait, 1}, collect());
    pipeline.submit(at(0.0), false, true);
    pipeline.submit(at(1e-4), false, true); // returns when the first is done
    // The second may be written meanwhile, and a folder with a file in it is not removed.
    for (std::error_code error; std::filesystem::exists(scratch.path() / "surface");) {
        std::filesystem::remove_all(scratch.path() / "surface", error);
    }
    pipeline.submit(at(2e-4), false, true);
    pipeline.finish();
    EXPECT_TRUE(warnings.empty() || warnings.size() == 1U);
}

TEST_F(PipelineTest, a_bad_snapshot_ends_files_and_pictures_but_not_the_run) {
    Pipeline pipeline(files, render, Backend::none, {}, collect());
    pipeline.submit(std::make_shared<Snapshot>(), false, true);
    pipeline.submit(at(0.0), false, true);
    pipeline.finish();
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("nodes"), std::string::npos) << warnings[0];
}

TEST_F(PipelineTest, a_dying_x_server_ends_the_pictures_not_the_process) {
    if (!can_render()) {
        GTEST_SKIP() << "no Xvfb";
    }
    Pipeline pipeline(files, render, Backend::xvfb, {BacklogPolicy::OnFull::wait, 1}, collect());
    pipeline.submit(at(0.0), true, true);
    pipeline.submit(at(1e-4), true, true);
    const auto servers = own_servers();
    ASSERT_EQ(servers.size(), 1U);
    kill(servers[0], SIGKILL);
    for (int i = 2; i < 6; ++i) {
        pipeline.submit(at(1e-4 * i), true, true);
    }
    pipeline.finish();
    EXPECT_EQ(pipeline.stats().files, 18);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("X server"), std::string::npos) << warnings[0];
}

TEST_F(PipelineTest, single_pictures_can_be_had_between_the_others) {
    if (!can_render()) {
        GTEST_SKIP() << "no Xvfb";
    }
    Pipeline pipeline(files, render, Backend::xvfb, {}, collect());
    const auto path = scratch.path() / "plots" / "look.png";
    pipeline.write_image(at(1e-4), "top", path);
    EXPECT_TRUE(std::filesystem::exists(path));
    EXPECT_THROW(pipeline.write_image(at(1e-4), "bottom", path), VizError);
    EXPECT_THROW(pipeline.write_image(nullptr, "top", path), VizError);
    pipeline.finish();
    EXPECT_EQ(pipeline.stats().frames, 0);
    EXPECT_THROW(pipeline.write_image(at(1e-4), "top", path), VizError);
}

TEST_F(PipelineTest, views_and_ranges_change_at_the_next_picture) {
    if (!can_render()) {
        GTEST_SKIP() << "no Xvfb";
    }
    Pipeline pipeline(files, render, Backend::xvfb, {}, collect());
    pipeline.submit(at(0.0), true, false);
    pipeline.set_views({"top"});
    pipeline.set_color_range({{300.0, 1000.0}});
    pipeline.submit(at(1e-4), true, false);
    EXPECT_THROW(pipeline.set_views({"bottom"}), VizError);
    EXPECT_THROW(pipeline.set_color_range({{5.0, 5.0}}), VizError);
    EXPECT_EQ(pipeline.render_options().views, std::vector<std::string>{"top"});
    pipeline.finish();
    EXPECT_TRUE(std::filesystem::exists(scratch.path() / "frames" / "overview_000000.png"));
    EXPECT_TRUE(std::filesystem::exists(scratch.path() / "frames" / "top_000001.png"));
    EXPECT_FALSE(std::filesystem::exists(scratch.path() / "frames" / "overview_000001.png"));
}

TEST_F(PipelineTest, a_resumed_run_goes_on_with_its_pictures) {
    if (!can_render()) {
        GTEST_SKIP() << "no Xvfb";
    }
    {
        Pipeline pipeline(files, render, Backend::xvfb, {}, collect());
        for (int i = 0; i < 4; ++i) {
            pipeline.submit(at(1e-4 * i), true, false);
        }
    }
    Pipeline pipeline(files, render, Backend::xvfb, {}, collect());
    pipeline.resume_at(1.5e-4);
    EXPECT_FALSE(std::filesystem::exists(scratch.path() / "frames" / "overview_000002.png"));
    pipeline.submit(at(2e-4), true, false);
    pipeline.finish();
    EXPECT_EQ(png_time(scratch.path() / "frames" / "overview_000001.png"), 1e-4);
    EXPECT_EQ(png_time(scratch.path() / "frames" / "overview_000002.png"), 2e-4);
    EXPECT_FALSE(std::filesystem::exists(scratch.path() / "frames" / "overview_000003.png"));
}

TEST_F(PipelineTest, impossible_queues_and_options_are_refused_at_the_start) {
    EXPECT_THROW(Pipeline(files, render, Backend::none, {BacklogPolicy::OnFull::wait, 0}, {}), VizError);
    render.views = {"nothing"};
    EXPECT_THROW(Pipeline(files, render, Backend::none, {}, {}), VizError);
}

} // namespace
} // namespace meltscope::viz
