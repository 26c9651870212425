#include "meltscope/io/checkpoint.hpp"

#include "checkpoint_example.hpp"
#include "checkpoint_seal.hpp"
#include "file_size_limit.hpp"
#include "temporary_folder.hpp"

#include <cstring>

namespace meltscope {
namespace {

using testing::contents_of;
using testing::example_checkpoint;
using testing::FileSizeLimit;
using testing::message_of;
using testing::TemporaryFolder;

template <class Value>
bool same_bits(const std::vector<Value>& a, const std::vector<Value>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Value)) == 0);
}

void expect_equal(const CheckpointData& a, const CheckpointData& b) {
    EXPECT_EQ(a.schema_version, b.schema_version);
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.step, b.step);
    EXPECT_EQ(a.dt, b.dt);
    EXPECT_TRUE(same_bits(a.particles.position, b.particles.position));
    EXPECT_TRUE(same_bits(a.particles.mass, b.particles.mass));
    EXPECT_TRUE(same_bits(a.particles.volume, b.particles.volume));
    EXPECT_TRUE(same_bits(a.particles.specific_energy, b.particles.specific_energy));
    EXPECT_EQ(a.particles.id, b.particles.id);
    EXPECT_EQ(a.particles.material, b.particles.material);
    EXPECT_EQ(a.particles.extra, b.particles.extra);
    ASSERT_EQ(a.grid.size(), b.grid.size());
    for (std::size_t n = 0; n < a.grid.size(); ++n) {
        EXPECT_EQ(a.grid[n].name, b.grid[n].name);
        EXPECT_EQ(a.grid[n].dims, b.grid[n].dims);
        EXPECT_TRUE(same_bits(a.grid[n].values, b.grid[n].values));
    }
    EXPECT_EQ(a.scenario, b.scenario);
    EXPECT_EQ(a.steering, b.steering);
    EXPECT_EQ(a.journal, b.journal);
    EXPECT_EQ(a.ledger, b.ledger);
}

std::string reading_error(const std::filesystem::path& path) {
    return message_of<CheckpointError>([&] { read_checkpoint(path); });
}

TEST(Checkpoint, reads_back_bit_for_bit) {
    const TemporaryFolder folder;
    for (const std::size_t count : {0u, 1u, 2u, 37u, 70000u}) {
        const auto data = example_checkpoint(count);
        write_checkpoint(folder / "a.h5", data);
        expect_equal(read_checkpoint(folder / "a.h5"), data);
    }
    EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(Checkpoint, equal_data_make_equal_files) {
    const TemporaryFolder folder;
    write_checkpoint(folder / "a.h5", example_checkpoint(100));
    write_checkpoint(folder / "b.h5", example_checkpoint(100));
    EXPECT_EQ(contents_of(folder / "a.h5"), contents_of(folder / "b.h5"));
    auto other = example_checkpoint(100);
    other.particles.mass[50] = std::nextafter(other.particles.mass[50], 1e9);
    write_checkpoint(folder / "b.h5", other);
    EXPECT_NE(contents_of(folder / "a.h5"), contents_of(folder / "b.h5"));
}

TEST(Checkpoint, refuses_every_truncation) {
    const TemporaryFolder folder;
    write_checkpoint(folder / "a.h5", example_checkpoint(37));
    const auto whole = contents_of(folder / "a.h5");
    std::mt19937 random(1);
    std::uniform_int_distribution<std::size_t> length(0, whole.size() - 1);
    for (int n = 0; n < 300; ++n) {
        const auto size = n == 0 ? whole.size() - 1 : length(random);
        testing::put(folder / "b.h5", whole.substr(0, size));
        EXPECT_THROW(read_checkpoint(folder / "b.h5"), CheckpointError) << size << " of " << whole.size();
    }
    testing::put(folder / "b.h5", whole + "x");
    EXPECT_NE(reading_error(folder / "b.h5").find("bytes"), std::string::npos);
}

TEST(Checkpoint, refuses_every_flipped_bit) {
    const TemporaryFolder folder;
    write_checkpoint(folder / "a.h5", example_checkpoint(37));
    const auto whole = contents_of(folder / "a.h5");
    std::mt19937 random(2);
    std::uniform_int_distribution<std::size_t> anywhere(0, 8 * whole.size() - 1);
    std::uniform_int_distribution<std::size_t> in_seal(0, 8 * seal_size - 1);
    for (int n = 0; n < 600; ++n) {
        auto damaged = whole;
        const auto bit = n % 3 == 0 ? in_seal(random) : anywhere(random);
        damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
        testing::put(folder / "b.h5", damaged);
        EXPECT_THROW(read_checkpoint(folder / "b.h5"), CheckpointError) << "bit " << bit;
    }
}

TEST(Checkpoint, refuses_pairs_of_flipped_top_bits) {
    const TemporaryFolder folder;
    write_checkpoint(folder / "a.h5", example_checkpoint(37));
    const auto whole = contents_of(folder / "a.h5");
    for (std::size_t byte = seal_size + 7; byte + 64 < whole.size(); byte += 256) {
        auto damaged = whole;
        damaged[byte] = static_cast<char>(damaged[byte] ^ 0x80);
        damaged[byte + 64] = static_cast<char>(damaged[byte + 64] ^ 0x80);
        testing::put(folder / "b.h5", damaged);
        EXPECT_THROW(read_checkpoint(folder / "b.h5"), CheckpointError) << byte;
    }
}

TEST(Checkpoint, refuses_swapped_blocks) {
    const TemporaryFolder folder;
    write_checkpoint(folder / "a.h5", example_checkpoint(500));
    auto damaged = contents_of(folder / "a.h5");
    std::swap_ranges(damaged.end() - 4096, damaged.end() - 2048, damaged.end() - 2048);
    testing::put(folder / "b.h5", damaged);
    EXPECT_NE(reading_error(folder / "b.h5").find("hash"), std::string::npos);
}

TEST(Checkpoint, refuses_foreign_files_by_name) {
    const TemporaryFolder folder;
    for (const std::string& foreign :
         {std::string(), std::string("time_s,laser_x_m\n"), "\x89HDF\r\n\x1a\n" + std::string(2000, '\0'),
          std::string(100000, 'm')}) {
        testing::put(folder / "a.h5", foreign);
        const auto message = reading_error(folder / "a.h5");
        EXPECT_NE(message.find("not a meltscope checkpoint"), std::string::npos) << message;
        EXPECT_NE(message.find("a.h5"), std::string::npos) << message;
    }
    EXPECT_NE(reading_error(folder.path()).find("is not a file"), std::string::npos);
    const auto missing = message_of<std::system_error>([&] { read_checkpoint(folder / "none.h5"); });
    EXPECT_NE(missing.find("No such file"), std::string::npos) << missing;
}

TEST(Checkpoint, names_the_schema_of_another_version) {
    const TemporaryFolder folder;
    write_checkpoint(folder / "a.h5", example_checkpoint(5));
    auto other = contents_of(folder / "a.h5");
    const auto at = other.find("schema 1\n");
    ASSERT_NE(at, std::string::npos);
    other[at + 7] = '2';
    testing::put(folder / "b.h5", other);
    const auto message = reading_error(folder / "b.h5");
    EXPECT_NE(message.find("schema 2"), std::string::npos) << message;
    EXPECT_NE(message.find("reads schema 1"), std::string::npos) << message;
    EXPECT_NE(message.find("newer"), std::string::npos) << message;
}

TEST(Checkpoint, keeps_the_former_one_when_the_disk_takes_no_more) {
    const TemporaryFolder folder;
    const auto former = example_checkpoint(10);
    write_checkpoint(folder / "a.h5", former);
    const auto larger = example_checkpoint(200000);
    for (rlim_t bytes = 0; bytes < 10000000; bytes = bytes * 5 / 4 + 97) {
        const FileSizeLimit limit(bytes);
        const auto message =
            message_of<std::runtime_error>([&] { write_checkpoint(folder / "a.h5", larger); });
        EXPECT_NE(message.find("a.h5"), std::string::npos) << message;
        EXPECT_NE(message.find("File too large"), std::string::npos) << message;
    }
    expect_equal(read_checkpoint(folder / "a.h5"), former);
    EXPECT_EQ(folder.entry_count(), 1u);
    // The failures have left nothing behind in HDF5 that would hinder the next checkpoint.
    write_checkpoint(folder / "a.h5", larger);
    expect_equal(read_checkpoint(folder / "a.h5"), larger);
}

TEST(Checkpoint, refuses_to_write_what_does_not_fit_together) {
    const TemporaryFolder folder;
    const auto refused = [&](auto spoil, const std::string& word) {
        auto data = example_checkpoint(10);
        spoil(data);
        const auto message = message_of<CheckpointError>([&] { write_checkpoint(folder / "a.h5", data); });
        EXPECT_NE(message.find(word), std::string::npos) << message;
    };
    refused([](auto& d) { d.particles.position.pop_back(); }, "position has 29 values for 10 particles");
    refused([](auto& d) { d.particles.material.push_back(0); }, "material");
    refused([](auto& d) { d.particles.extra[0].second.pop_back(); }, "energy_gradient");
    refused([](auto& d) { d.particles.extra[0].second.clear(); }, "energy_gradient");
    refused([](auto& d) { d.particles.extra[0].first = "mass"; }, "twice");
    refused([](auto& d) { d.particles.extra[0].first = "../scenario"; }, "slash");
    refused([](auto& d) { d.grid[0].dims[0] = 2; }, "phi");
    refused([](auto& d) { d.grid[0].name.clear(); }, "no name");
    refused([](auto& d) { d.ledger[1].first = d.ledger[0].first; }, "twice");
    refused([](auto& d) { d.scenario += '\0'; }, "NUL");
    refused([](auto& d) { d.schema_version = 2; }, "schema");
    EXPECT_EQ(folder.entry_count(), 0u);
}

TEST(Checkpoint, is_readable_with_h5py) {
    const TemporaryFolder folder;
    CheckpointData data = example_checkpoint(4);
    data.particles.position = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    data.particles.specific_energy = {1, 2, 3, 4};
    write_checkpoint(folder / "a.h5", data);
    const auto command = "/usr/bin/python3 " MELTSCOPE_SOURCE_DIR "/tests/unit/io/read_with_h5py.py " +
                         (folder / "a.h5").string();
    EXPECT_EQ(std::system(command.c_str()), 0);
}

} // namespace
} // namespace meltscope
