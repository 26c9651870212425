#include "temporary_folder.hpp"

#include "meltscope/io/solidification_table.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace meltscope {
namespace {

using namespace testing;

TEST(SolidificationTable, has_a_row_an_event_under_the_header_that_codes_of_grain_growth_read) {
    const TemporaryFolder folder;
    const auto path = folder / "solidification.csv";
    SolidifiedPoint point;
    point.position = Vec3(1.12e-4, -0.0, -2.0e-20); // m; the last is the round-off of a sum of cells
    point.melted = 1.5e-5;
    point.solidified = 2.5e-5;
    point.cooling_rate = 4e6;
    write_solidification_table(path, std::vector<SolidifiedPoint>{point, point});
    const std::string row = "0.000112,0,0,1.5e-05,2.5e-05,4000000\n";
    EXPECT_EQ(contents_of(path), "x,y,z,tm,tl,cr\n" + row + row);
}

} // namespace
} // namespace meltscope
