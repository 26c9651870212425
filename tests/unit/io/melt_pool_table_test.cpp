#include "meltscope/io/melt_pool_table.hpp"

#include "file_size_limit.hpp"
#include "temporary_folder.hpp"

#include <system_error>

namespace meltscope {
namespace {

using testing::contents_of;
using testing::FileSizeLimit;
using testing::message_of;
using testing::put;
using testing::TemporaryFolder;

constexpr const char* header =
    "time_s,laser_x_m,laser_y_m,power_W,speed_m_s,length_m,width_m,depth_m,volume_m3,"
    "peak_K,liquid_particles,absorbed_J,lost_J";

Snapshot snapshot_at(double time, const std::vector<double>& isotherms = {1620}) {
    Snapshot snapshot;
    snapshot.time = time;
    snapshot.peak_temperature = 3000.5;
    snapshot.liquid_particles = 42;
    snapshot.absorbed_energy = 0.1;
    snapshot.lost_energy = 0.25;
    BeamSnapshot beam;
    beam.position = {1e-3, -2e-4, 0};
    beam.power = 195;
    beam.speed = 0.8;
    snapshot.beams = {beam, BeamSnapshot{}};
    for (const double isotherm : isotherms)
        snapshot.pools.push_back({isotherm, 3e-4, 1e-4, 5e-5, 7.5e-13});
    return snapshot;
}

TEST(MeltPoolTable, has_the_columns_of_the_interface) {
    EXPECT_EQ(melt_pool_header({1620}), header);
    EXPECT_EQ(melt_pool_header({1620, 1563, 1500.1499999999999}),
              "time_s,laser_x_m,laser_y_m,power_W,speed_m_s,length_m,width_m,depth_m,volume_m3,"
              "length_m_1563K,width_m_1563K,depth_m_1563K,volume_m3_1563K,"
              "length_m_1500.15K,width_m_1500.15K,depth_m_1500.15K,volume_m3_1500.15K,"
              "peak_K,liquid_particles,absorbed_J,lost_J");
    EXPECT_THROW(melt_pool_header({}), std::invalid_argument);
    EXPECT_THROW(melt_pool_header({1620, 1500, 1620}), std::invalid_argument);
}

TEST(MeltPoolTable, row_is_in_the_file_when_append_returns) {
    const TemporaryFolder folder;
    MeltPoolTable table(folder / "melt_pool.csv", {1620});
    table.append(snapshot_at(0.1 + 0.2));
    EXPECT_EQ(
        contents_of(folder / "melt_pool.csv"),
        std::string(header) +
            "\n0.30000000000000004,0.001,-0.0002,195,0.8,0.0003,0.0001,5e-05,7.5e-13,3000.5,42,0.1,0.25\n");
}

TEST(MeltPoolTable, says_nan_where_no_laser_is) {
    const TemporaryFolder folder;
    MeltPoolTable table(folder / "melt_pool.csv", {1620});
    auto snapshot = snapshot_at(0);
    snapshot.beams.clear();
    table.append(snapshot);
    EXPECT_NE(contents_of(folder / "melt_pool.csv").find("\n0,nan,nan,0,0,0.0003,"), std::string::npos);
}

TEST(MeltPoolTable, refuses_pools_of_other_isotherms) {
    const TemporaryFolder folder;
    MeltPoolTable table(folder / "melt_pool.csv", {1620, 1563});
    EXPECT_THROW(table.append(snapshot_at(0, {1620})), std::invalid_argument);
    EXPECT_THROW(table.append(snapshot_at(0, {1563, 1620})), std::invalid_argument);
    EXPECT_NO_THROW(table.append(snapshot_at(0, {1620, 1563})));
}

TEST(MeltPoolTable, restart_drops_rows_at_or_after_its_time_and_a_torn_row) {
    const TemporaryFolder folder;
    const auto path = folder / "melt_pool.csv";
    {
        MeltPoolTable table(path, {1620});
        for (const double time : {1e-4, 2e-4, 3e-4, 4e-4})
            table.append(snapshot_at(time));
    }
    put(path, contents_of(path) + "0.0005,0.00");
    {
        MeltPoolTable table(path, {1620}, 3e-4);
        table.append(snapshot_at(3e-4));
    }
    {
        MeltPoolTable uninterrupted(folder / "other.csv", {1620});
        for (const double time : {1e-4, 2e-4, 3e-4})
            uninterrupted.append(snapshot_at(time));
    }
    EXPECT_EQ(contents_of(path), contents_of(folder / "other.csv"));
}

TEST(MeltPoolTable, restart_without_a_table_starts_one) {
    const TemporaryFolder folder;
    MeltPoolTable table(folder / "melt_pool.csv", {1620}, 1e-3);
    EXPECT_EQ(contents_of(folder / "melt_pool.csv"), std::string(header) + "\n");
}

TEST(MeltPoolTable, restart_refuses_another_table_and_keeps_it) {
    const TemporaryFolder folder;
    const auto path = folder / "melt_pool.csv";
    { MeltPoolTable(path, {1620}).append(snapshot_at(1e-4)); }
    const auto former = contents_of(path);
    EXPECT_THROW(MeltPoolTable(path, {1620, 1500}, 1.0), TableError);
    EXPECT_EQ(contents_of(path), former);
    put(path, former + "nonsense\n" + "0.0002,1\n");
    const auto message = message_of<TableError>([&] { MeltPoolTable(path, {1620}, 1.0); });
    EXPECT_NE(message.find(":3:"), std::string::npos) << message;
}

TEST(MeltPoolTable, takes_back_a_row_that_the_disk_cannot_hold) {
    const TemporaryFolder folder;
    const auto path = folder / "melt_pool.csv";
    MeltPoolTable table(path, {1620});
    table.append(snapshot_at(1e-4));
    const auto former = contents_of(path);
    {
        const FileSizeLimit limit(former.size() + 10);
        EXPECT_THROW(table.append(snapshot_at(2e-4)), std::system_error);
    }
    EXPECT_EQ(contents_of(path), former);
    table.append(snapshot_at(2e-4));
    EXPECT_GT(contents_of(path).size(), former.size());
}

} // namespace
} // namespace meltscope
