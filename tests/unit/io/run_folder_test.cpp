#include "meltscope/io/run_folder.hpp"

#include "temporary_folder.hpp"

#include <csignal>
#include <sys/wait.h>
#include <unistd.h>

namespace meltscope {
namespace {

namespace fs = std::filesystem;
using testing::message_of;
using testing::put;
using testing::TemporaryFolder;

constexpr const char* outputs[] = {"run.toml",         "run.json",
                                   "journal.txt",      "log.txt",
                                   "melt_pool.csv",    "report.html",
                                   "particles.pvd",    "particles/particles_000012.vtp",
                                   "surface.pvd",      "surface/surface_000012.vtp",
                                   "grid/grid_1.vti",  "pool/pool_000001.vtp",
                                   "overview.mp4",     "frames/overview_000012.png",
                                   "plots/length.png", "checkpoints/step_000000500.h5",
                                   ".run.json.77.tmp", "checkpoints/.step_000000500.h5.77.tmp",
                                   "surface.pvd.part", "surface/surface_000013.vtp.part"};
constexpr const char* others[] = {"notes.txt",
                                  "run.toml.bak",
                                  "holiday.mp4",
                                  "frames/me.png",
                                  "frames/raw/overview_000001.png",
                                  "checkpoints/mine.h5",
                                  "checkpoints/step_1.h5.gz",
                                  "data/particles.pvd",
                                  ".config.tmp",
                                  "download.zip.part",
                                  "particles/dem.csv"};

TEST(RunPaths, are_those_of_the_interface) {
    const RunPaths paths{"runs/a"};
    EXPECT_EQ(paths.checkpoint(500), "runs/a/checkpoints/step_000000500.h5");
    EXPECT_EQ(paths.checkpoint(12345678901), "runs/a/checkpoints/step_12345678901.h5");
    EXPECT_EQ(paths.frame("overview", 12), "runs/a/frames/overview_000012.png");
    EXPECT_EQ(paths.movie("overview"), "runs/a/overview.mp4");
    EXPECT_EQ(paths.collection("surface"), "runs/a/surface.pvd");
    EXPECT_EQ(paths.melt_pool_table(), "runs/a/melt_pool.csv");
}

TEST(RunFolder, is_made_with_its_parents_and_leaves_no_lock) {
    const TemporaryFolder folder;
    {
        const RunFolder run(folder / "runs/a", ExistingRun::refuse);
        EXPECT_TRUE(fs::exists(run.paths().lock()));
        EXPECT_FALSE(run.stale_owner());
    }
    EXPECT_TRUE(fs::is_empty(folder / "runs/a"));
}

TEST(RunFolder, that_holds_something_is_refused_and_left_as_it_was) {
    const TemporaryFolder folder;
    put(folder / "run.toml", "precious");
    const auto message = message_of<RunFolderError>([&] { RunFolder(folder.path(), ExistingRun::refuse); });
    EXPECT_NE(message.find("--overwrite"), std::string::npos) << message;
    EXPECT_EQ(testing::contents_of(folder / "run.toml"), "precious");
    EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(RunFolder, overwriting_removes_its_outputs_and_nothing_else) {
    const TemporaryFolder folder;
    for (const auto* name : outputs)
        put(folder / name);
    for (const auto* name : others)
        put(folder / name);
    const RunFolder run(folder.path(), ExistingRun::overwrite);
    for (const auto* name : outputs)
        EXPECT_FALSE(fs::exists(folder / name)) << name;
    for (const auto* name : others)
        EXPECT_TRUE(fs::exists(folder / name)) << name;
    EXPECT_FALSE(fs::exists(folder / "surface")) << "an emptied folder goes too";
}

TEST(RunFolder, overwriting_does_not_follow_links) {
    const TemporaryFolder folder;
    put(folder / "elsewhere/overview_000001.png");
    fs::create_directory(folder / "run");
    fs::create_directory_symlink(folder / "elsewhere", folder / "run/frames");
    const RunFolder run(folder / "run", ExistingRun::overwrite);
    EXPECT_TRUE(fs::exists(folder / "elsewhere/overview_000001.png"));
}

TEST(RunFolder, resuming_removes_only_leftover_temporaries) {
    const TemporaryFolder folder;
    for (const auto* name : outputs)
        put(folder / name);
    const RunFolder run(folder.path(), ExistingRun::resume);
    for (const auto* name : outputs) {
        const bool is_temporary = std::string(name).ends_with(".tmp") || std::string(name).ends_with(".part");
        EXPECT_EQ(fs::exists(folder / name), !is_temporary) << name;
    }
}

TEST(RunFolder, in_use_is_refused_to_a_second_run_whatever_it_asks) {
    const TemporaryFolder folder;
    const RunFolder first(folder / "a", ExistingRun::refuse);
    put(folder / "a/run.toml");
    for (const auto existing : {ExistingRun::refuse, ExistingRun::overwrite, ExistingRun::resume}) {
        const auto message = message_of<RunFolderError>([&] { RunFolder(folder / "a", existing); });
        EXPECT_NE(message.find("in use"), std::string::npos) << message;
        EXPECT_NE(message.find(std::to_string(::getpid())), std::string::npos) << message;
    }
    EXPECT_TRUE(fs::exists(folder / "a/run.toml"));
    EXPECT_TRUE(fs::exists(first.paths().lock()));
}

TEST(RunFolder, lock_of_a_killed_run_is_recognised_as_stale) {
    const TemporaryFolder folder;
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        const RunFolder run(folder / "a", ExistingRun::refuse);
        if (::write(ready[1], "x", 1) != 1)
            ::_exit(1);
        for (;;)
            ::pause();
    }
    char byte = 0;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    EXPECT_THROW(RunFolder(folder / "a", ExistingRun::resume), RunFolderError);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const RunFolder run(folder / "a", ExistingRun::refuse);
    EXPECT_EQ(run.stale_owner(), child);
    ::close(ready[0]);
    ::close(ready[1]);
}

TEST(Checkpoints, are_listed_by_step_and_pruned_to_the_latest) {
    const TemporaryFolder folder;
    const RunPaths paths{folder.path()};
    EXPECT_TRUE(list_checkpoints(paths).empty());
    for (const std::int64_t step : {500, 12, 2000000000, 100})
        put(paths.checkpoint(step));
    put(paths.checkpoints() / "mine.h5");
    const auto found = list_checkpoints(paths);
    ASSERT_EQ(found.size(), 4u);
    EXPECT_EQ(found.front().step, 12);
    EXPECT_EQ(found.back().step, 2000000000);
    EXPECT_EQ(found.back().path, paths.checkpoint(2000000000));

    EXPECT_THROW(prune_checkpoints(paths, 0), std::invalid_argument);
    prune_checkpoints(paths, 2);
    ASSERT_EQ(list_checkpoints(paths).size(), 2u);
    EXPECT_EQ(list_checkpoints(paths).front().step, 500);
    prune_checkpoints(paths, 5);
    EXPECT_EQ(list_checkpoints(paths).size(), 2u);
    drop_checkpoints_after(paths, 500);
    ASSERT_EQ(list_checkpoints(paths).size(), 1u);
    EXPECT_EQ(list_checkpoints(paths).front().step, 500);
    EXPECT_TRUE(fs::exists(paths.checkpoints() / "mine.h5"));
}

} // namespace
} // namespace meltscope
