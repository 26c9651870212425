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
    snapshot.beams = {beam};
    for (const double isotherm : isotherms)
        snapshot.pools.push_back({isotherm, 3e-4, 1e-4, 5e-5, 7.5e-13});
    return snapshot;
}

TEST(MeltPoolTable, has_the_columns_of_the_interface) {
    EXPECT_EQ(melt_pool_header({1620}, {}), header);
    EXPECT_EQ(melt_pool_header({1620, 1563, 1500.1499999999999}, {"laser"}),
              "time_s,laser_x_m,laser_y_m,power_W,speed_m_s,length_m,width_m,depth_m,volume_m3,"
              "length_m_1563K,width_m_1563K,depth_m_1563K,volume_m3_1563K,"
              "length_m_1500.15K,width_m_1500.15K,depth_m_1500.15K,volume_m3_1500.15K,"
              "peak_K,liquid_particles,absorbed_J,lost_J");
    EXPECT_THROW(melt_pool_header({}, {}), std::invalid_argument);
    EXPECT_THROW(melt_pool_header({1620, 1500, 1620}, {}), std::invalid_argument);
}

TEST(MeltPoolTable, row_is_in_the_file_when_append_returns) {
    const TemporaryFolder folder;
    MeltPoolTable table(folder / "melt_pool.csv", {1620}, {"laser"});
    table.append(snapshot_at(0.1 + 0.2));
    EXPECT_EQ(
        contents_of(folder / "melt_pool.csv"),
        std::string(header) +
            "\n0.30000000000000004,0.001,-0.0002,195,0.8,0.0003,0.0001,5e-05,7.5e-13,3000.5,42,0.1,0.25\n");
}

TEST(MeltPoolTable, says_nan_where_no_laser_is) {
    const TemporaryFolder folder;
    MeltPoolTable table(folder / "melt_pool.csv", {1620}, {});
    auto snapshot = snapshot_at(0);
    snapshot.beams.clear();
    table.append(snapshot);
    EXPECT_NE(contents_of(folder / "melt_pool.csv").find("\n0,nan,nan,0,0,0.0003,"), std::string::npos);
}

TEST(MeltPoolTable, refuses_pools_of_other_isotherms) {
    const TemporaryFolder folder;
    MeltPoolTable table(folder / "melt_pool.csv", {1620, 1563}, {"laser"});
    EXPECT_THROW(table.append(snapshot_at(0, {1620})), std::invalid_argument);
    EXPECT_THROW(table.append(snapshot_at(0, {1563, 1620})), std::invalid_argument);
    EXPECT_NO_THROW(table.append(snapshot_at(0, {1620, 1563})));
}

TEST(MeltPoolTable, gives_each_further_laser_columns_of_its_own_at_the_end) {
    const TemporaryFolder folder;
    const std::vector<std::string> lasers{"left", "right"};
    EXPECT_EQ(melt_pool_header({1620}, lasers),
              std::string(header) + ",laser_x_m_right,laser_y_m_right,power_W_right,speed_m_s_right,"
                                    "length_m_right,width_m_right,depth_m_right,volume_m3_right");
    MeltPoolTable table(folder / "melt_pool.csv", {1620}, lasers);
    auto snapshot = snapshot_at(0);
    EXPECT_THROW(table.append(snapshot), std::invalid_argument);
    BeamSnapshot right;
    right.position = {5e-4, 1e-4, 0};
    right.power = 90;
    right.speed = 0.5;
    right.pools = {{1620, 2e-4, 8e-5, 4e-5, 3e-13}};
    snapshot.beams.push_back(right);
    table.append(snapshot);
    EXPECT_NE(contents_of(folder / "melt_pool.csv").find(",0.0005,0.0001,90,0.5,0.0002,8e-05,4e-05,3e-13\n"),
              std::string::npos);
}

TEST(SeparatePoolsTable, has_a_row_for_each_pool_numbered_by_isotherm) {
    const TemporaryFolder folder;
    SeparatePoolsTable table(folder / "melt_pools.csv");
    auto snapshot = snapshot_at(1e-4);
    table.append(snapshot); // nothing molten: no row
    BeamSnapshot right;
    snapshot.beams.front().name = "left";
    right.name = "right";
    snapshot.beams.push_back(right);
    const PoolFigures figures{1620, 3e-4, 1e-4, 5e-5, 7.5e-13};
    snapshot.separate_pools = {{figures, {1e-3, 0, 0}, 2500, {0, 1}}, {figures, {2e-3, 0, 0}, 1700, {}}};
    PoolFigures other = figures;
    other.isotherm = 1563;
    snapshot.separate_pools.push_back({other, {0, 0, 0}, 2500, {1}});
    table.append(snapshot);
    EXPECT_EQ(contents_of(folder / "melt_pools.csv"),
              "time_s,isotherm_K,pool,lasers,x_m,y_m,z_m,length_m,width_m,depth_m,volume_m3,peak_K\n"
              "0.0001,1620,1,left+right,0.001,0,0,0.0003,0.0001,5e-05,7.5e-13,2500\n"
              "0.0001,1620,2,,0.002,0,0,0.0003,0.0001,5e-05,7.5e-13,1700\n"
              "0.0001,1563,1,right,0,0,0,0.0003,0.0001,5e-05,7.5e-13,2500\n");
}

TEST(MeltPoolTable, restart_drops_rows_at_or_after_its_time_and_a_torn_row) {
    const TemporaryFolder folder;
    const auto path = folder / "melt_pool.csv";
    {
        MeltPoolTable table(path, {1620}, {"laser"});
        for (const double time : {1e-4, 2e-4, 3e-4, 4e-4})
            table.append(snapshot_at(time));
    }
    put(path, contents_of(path) + "0.0005,0.00");
    {
        MeltPoolTable table(path, {1620}, {"laser"}, 3e-4);
        table.append(snapshot_at(3e-4));
    }
    {
        MeltPoolTable uninterrupted(folder / "other.csv", {1620}, {"laser"});
        for (const double time : {1e-4, 2e-4, 3e-4})
            uninterrupted.append(snapshot_at(time));
    }
    EXPECT_EQ(contents_of(path), contents_of(folder / "other.csv"));
}

TEST(MeltPoolTable, goes_on_in_a_new_file_if_somebody_has_removed_it) {
    const TemporaryFolder folder;
    const auto path = folder / "run" / "melt_pool.csv";
    std::filesystem::create_directories(path.parent_path());
    MeltPoolTable table(path, {1620}, {"laser"});
    table.append(snapshot_at(1e-4));
    std::filesystem::remove_all(path.parent_path());
    table.append(snapshot_at(2e-4));
    EXPECT_EQ(contents_of(path).rfind(std::string(header) + "\n0.0002,", 0), 0U) << contents_of(path);
}

TEST(MeltPoolTable, restart_without_a_table_starts_one) {
    const TemporaryFolder folder;
    MeltPoolTable table(folder / "melt_pool.csv", {1620}, {"laser"}, 1e-3);
    EXPECT_EQ(contents_of(folder / "melt_pool.csv"), std::string(header) + "\n");
}

TEST(MeltPoolTable, restart_refuses_another_table_and_keeps_it) {
    const TemporaryFolder folder;
    const auto path = folder / "melt_pool.csv";
    { MeltPoolTable(path, {1620}, {"laser"}).append(snapshot_at(1e-4)); }
    const auto former = contents_of(path);
    EXPECT_THROW(MeltPoolTable(path, {1620, 1500}, {"laser"}, 1.0), TableError);
    EXPECT_EQ(contents_of(path), former);
    put(path, former + "nonsense\n" + "0.0002,1\n");
    const auto message = message_of<TableError>([&] { MeltPoolTable(path, {1620}, {"laser"}, 1.0); });
    EXPECT_NE(message.find(":3:"), std::string::npos) << message;
}

TEST(MeltPoolTable, takes_back_a_row_that_the_disk_cannot_hold) {
    const TemporaryFolder folder;
    const auto path = folder / "melt_pool.csv";
    MeltPoolTable table(path, {1620}, {"laser"});
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
