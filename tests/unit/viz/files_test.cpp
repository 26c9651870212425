#include "scratch.hpp"
#include "synthetic.hpp"
#include "viz/pipeline.hpp"
#include "viz/pvd.hpp"

#include <atomic>
#include <fstream>
#include <gtest/gtest.h>
#include <thread>

namespace meltscope::viz {
namespace {

std::vector<PvdCollection::Entry> entries_of(const std::filesystem::path& path) {
    PvdCollection collection(path);
    collection.load();
    return collection.entries();
}

/// Runs the given times through a pipeline that only writes files.
void write_files(const std::filesystem::path& folder, const std::vector<double>& times,
                 std::optional<double> resume = {}) {
    FileOptions files;
    files.run_dir = folder;
    RenderOptions render;
    render.run_dir = folder;
    Pipeline pipeline(files, render, Backend::none, {},
                      [](const std::string& words) { ADD_FAILURE() << words; });
    if (resume) {
        pipeline.resume_at(*resume);
    }
    test::SyntheticPlate plate;
    plate.count = {61, 21, 13};
    for (const double time : times) {
        pipeline.submit(test::make_snapshot(plate, time), false, true);
    }
}

TEST(Pvd, times_survive_writing_and_reading_to_the_last_bit) {
    const test::ScratchFolder scratch;
    const auto path = scratch.path() / "surface.pvd";
    PvdCollection collection(path);
    const std::vector<double> times{0.0, 1.0 / 3.0, 1e-7, 0.1 + 0.2};
    for (const double time : times) {
        collection.append(time, "surface/x.vtp");
    }
    const auto read = entries_of(path);
    ASSERT_EQ(read.size(), times.size());
    for (std::size_t i = 0; i < times.size(); ++i) {
        EXPECT_EQ(read[i].time, times[i]);
        EXPECT_EQ(read[i].file, "surface/x.vtp");
    }
}

TEST(Pvd, a_collection_is_whole_whenever_it_is_read) {
    const test::ScratchFolder scratch;
    const auto path = scratch.path() / "grid.pvd";
    PvdCollection collection(path);
    collection.append(0.0, "grid/0.vti");
    std::atomic<bool> ready = false;
    std::thread writer([&] {
        while (!ready) {
        }
        for (int i = 1; i < 200; ++i) {
            collection.append(i, "grid/x.vti");
        }
    });
    std::size_t most = 0;
    ready = true;
    while (most < 200) {
        std::ifstream stream(path);
        const std::string text((std::istreambuf_iterator<char>(stream)), {});
        ASSERT_TRUE(text.ends_with("</VTKFile>\n")) << text;
        const auto read = entries_of(path);
        ASSERT_GE(read.size(), most);
        most = read.size();
    }
    writer.join();
}

TEST(Pvd, other_files_are_refused) {
    const test::ScratchFolder scratch;
    const auto path = scratch.path() / "pool.pvd";
    std::ofstream(path) << "not a collection\n";
    PvdCollection collection(path);
    EXPECT_THROW(collection.load(), VizError);
}

TEST(Files, a_resumed_run_has_no_time_twice_and_loses_no_file) {
    const test::ScratchFolder scratch;
    write_files(scratch.path(), {0.0, 1e-4, 2e-4, 3e-4});
    write_files(scratch.path(), {2e-4, 3e-4, 4e-4}, 2e-4);
    const auto entries = entries_of(scratch.path() / "surface.pvd");
    ASSERT_EQ(entries.size(), 5U);
    for (std::size_t i = 0; i < entries.size(); ++i) {
        EXPECT_DOUBLE_EQ(entries[i].time, 1e-4 * static_cast<double>(i));
        EXPECT_TRUE(std::filesystem::exists(scratch.path() / entries[i].file)) << entries[i].file;
    }
    EXPECT_EQ(entries[2].file, "surface/surface_000002.vtp");
}

TEST(Files, their_size_is_foretold_within_a_quarter) {
    const test::ScratchFolder scratch;
    FileOptions files;
    files.run_dir = scratch.path();
    files.grid = true;
    RenderOptions render;
    render.run_dir = scratch.path();
    test::SyntheticPlate plate;
    plate.count = {121, 61, 31};
    const auto snapshot = test::make_snapshot(plate, 3e-4);
    for (const Precision precision : {Precision::float32, Precision::float64}) {
        files.precision = precision;
        {
            Pipeline pipeline(files, render, Backend::none, {}, {});
            pipeline.submit(snapshot, false, true);
        }
        std::uintmax_t bytes = 0;
        for (const auto& file : std::filesystem::recursive_directory_iterator(scratch.path())) {
            bytes += file.is_regular_file() ? file.file_size() : 0;
        }
        const auto foretold = static_cast<double>(estimate_file_bytes(*snapshot, files));
        EXPECT_NEAR(foretold, static_cast<double>(bytes), 0.25 * static_cast<double>(bytes));
    }
}

TEST(Files, kinds_that_are_switched_off_are_not_written) {
    const test::ScratchFolder scratch;
    FileOptions files;
    files.run_dir = scratch.path();
    files.pool = false;
    files.particles = false;
    RenderOptions render;
    render.run_dir = scratch.path();
    Pipeline pipeline(files, render, Backend::none, {}, {});
    test::SyntheticPlate plate;
    plate.count = {31, 21, 13};
    pipeline.submit(test::make_snapshot(plate, 0.0), false, true);
    pipeline.finish();
    EXPECT_EQ(pipeline.stats().files, 1);
    EXPECT_TRUE(std::filesystem::exists(scratch.path() / "surface.pvd"));
    EXPECT_FALSE(std::filesystem::exists(scratch.path() / "pool.pvd"));
    EXPECT_FALSE(std::filesystem::exists(scratch.path() / "particles.pvd"));
    EXPECT_FALSE(std::filesystem::exists(scratch.path() / "grid.pvd"));
}

} // namespace
} // namespace meltscope::viz
