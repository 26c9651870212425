#include "example.hpp"

namespace meltscope {
namespace {

using test::example;
using test::with;
using Changes = std::vector<std::string>;

Changes changes_to(const std::string& text, const std::vector<std::string>& overrides = {}) {
    return scenario_changes(read_scenario_text(example), read_scenario_text(text, overrides));
}

TEST(ScenarioChanges, of_a_scenario_to_itself_are_none) {
    EXPECT_EQ(changes_to(example), Changes{});
    EXPECT_EQ(changes_to(with("\"100 W\"", "100.0")), Changes{}); // the same, written otherwise
}

TEST(ScenarioChanges, name_key_old_and_new_value) {
    EXPECT_EQ(changes_to(example, {"laser.power=250 W", "checkpoint.keep=5"}),
              (Changes{"checkpoint.keep: 3 -> 5", "laser[0].power: 100 -> 250"}));
}

TEST(ScenarioChanges, name_what_was_not_set_before) {
    EXPECT_EQ(changes_to(example, {"time.max_step=1 us"}), Changes{"time.max_step: not set -> 1e-06"});
}

TEST(ScenarioChanges, of_a_long_list_are_told_by_its_key) {
    const auto changes = changes_to(
        example, {"material.steel.conductivity={solid = [21.123456789, 0.0123456789, 1e-9], liquid = [30]}"});
    EXPECT_EQ(changes, Changes{"material.steel.conductivity.solid: another"});
}

} // namespace
} // namespace meltscope
