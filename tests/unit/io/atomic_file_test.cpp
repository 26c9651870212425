#include "meltscope/io/atomic_file.hpp"

#include "file_size_limit.hpp"
#include "temporary_folder.hpp"

#include <cerrno>
#include <system_error>

namespace meltscope {
namespace {

using testing::contents_of;
using testing::FileSizeLimit;
using testing::message_of;
using testing::TemporaryFolder;

TEST(AtomicFile, replaces_the_former_file_and_leaves_nothing_else) {
    const TemporaryFolder folder;
    testing::put(folder / "a.txt", "old");
    write_file_atomically(folder / "a.txt", "new");
    EXPECT_EQ(contents_of(folder / "a.txt"), "new");
    EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(AtomicFile, is_not_there_under_its_name_before_commit) {
    const TemporaryFolder folder;
    AtomicFile file(folder / "a.txt");
    file.write("half");
    EXPECT_FALSE(std::filesystem::exists(folder / "a.txt"));
    EXPECT_TRUE(std::filesystem::exists(file.temporary_path()));
    file.commit();
    EXPECT_EQ(contents_of(folder / "a.txt"), "half");
}

TEST(AtomicFile, removes_the_temporary_when_abandoned_and_keeps_the_former_file) {
    const TemporaryFolder folder;
    testing::put(folder / "a.txt", "old");
    { AtomicFile(folder / "a.txt").write("half"); }
    EXPECT_EQ(contents_of(folder / "a.txt"), "old");
    EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(AtomicFile, keeps_the_former_file_when_the_disk_takes_no_more) {
    const TemporaryFolder folder;
    testing::put(folder / "a.txt", "old");
    {
        const FileSizeLimit limit(1000);
        try {
            write_file_atomically(folder / "a.txt", std::string(5000, 'x'));
            ADD_FAILURE() << "writing succeeded";
        } catch (const std::system_error& error) {
            EXPECT_EQ(error.code().value(), EFBIG);
            EXPECT_NE(std::string(error.what()).find("a.txt"), std::string::npos) << error.what();
        }
    }
    EXPECT_EQ(contents_of(folder / "a.txt"), "old");
    EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(AtomicFile, names_path_and_reason_when_the_folder_is_missing) {
    const TemporaryFolder folder;
    const auto message =
        message_of<std::system_error>([&] { write_file_atomically(folder / "none" / "a.txt", "x"); });
    EXPECT_NE(message.find("none/a.txt"), std::string::npos) << message;
    EXPECT_NE(message.find("No such file or directory"), std::string::npos) << message;
}

TEST(AtomicFile, fails_when_its_folder_is_removed_meanwhile) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "run");
    AtomicFile file(folder / "run" / "a.txt");
    file.write("x");
    std::filesystem::remove_all(folder / "run");
    EXPECT_THROW(file.commit(), std::system_error);
}

TEST(AtomicFile, knows_the_names_of_its_temporaries) {
    EXPECT_EQ(final_name_of_temporary(".step_000000500.h5.1234.tmp"), "step_000000500.h5");
    for (const auto* other :
         {"a.txt", ".a.txt", ".a.tmp", ".a.txt.12x.tmp", "a.txt.12.tmp", ".12.tmp", ".a..tmp"})
        EXPECT_EQ(final_name_of_temporary(other), "") << other;
    const TemporaryFolder folder;
    const AtomicFile file(folder / "a.b.c");
    EXPECT_EQ(final_name_of_temporary(file.temporary_path().filename().string()), "a.b.c");
}

} // namespace
} // namespace meltscope
