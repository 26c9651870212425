#include "meltscope/io/run_summary.hpp"

#include "temporary_folder.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace meltscope {
namespace {

using testing::contents_of;
using testing::message_of;
using testing::TemporaryFolder;

RunSummary example() {
    RunSummary summary;
    summary.version = "0.1.0";
    summary.git_hash = "abc";
    summary.title = "a \"bare\" plate";
    summary.outcome = "done";
    summary.threads = 2;
    summary.particles = 2000000000000;
    summary.steps = 123;
    summary.time = 1e-3;
    summary.wall_seconds = {{"solver", 1.5}, {"level_set", 0.25}, {"in_situ", 0.5}, {"output", 0.125}};
    summary.particle_steps_per_second = 1e8;
    summary.ledger = {{"stored", 0.1}, {"absorbed", 0.1}};
    return summary;
}

TEST(RunSummary, reads_back_as_written) {
    const TemporaryFolder folder;
    write_run_summary(folder / "run.json", example());
    const auto back = read_run_summary(folder / "run.json");
    EXPECT_EQ(back.title, example().title);
    EXPECT_EQ(back.particles, example().particles);
    EXPECT_EQ(back.wall_seconds, example().wall_seconds);
    EXPECT_EQ(back.ledger, example().ledger) << "in the order written";
    EXPECT_EQ(to_json(back), to_json(example()));
}

TEST(RunSummary, is_json_with_the_keys_of_the_interface) {
    const auto json = nlohmann::json::parse(to_json(example()));
    EXPECT_EQ(json["threads"], 2);
    EXPECT_EQ(json["wall_seconds"]["in_situ"], 0.5);
    EXPECT_EQ(json["particle_steps_per_second"], 1e8);
    EXPECT_EQ(json["ledger"]["absorbed"], 0.1);
}

TEST(RunSummary, stays_valid_json_with_numbers_and_texts_that_json_has_not) {
    const TemporaryFolder folder;
    auto summary = example();
    summary.ledger[0].second = std::nan("");
    summary.title = "latin-1 \xe9";
    write_run_summary(folder / "run.json", summary);
    EXPECT_TRUE(std::isnan(read_run_summary(folder / "run.json").ledger[0].second));
}

TEST(RunSummary, that_is_none_is_refused_with_its_name) {
    const TemporaryFolder folder;
    for (const auto* text : {"", "{", "[]", "{\"version\": 3}", "{\"version\": \"1\"}"}) {
        testing::put(folder / "run.json", text);
        const auto message = message_of<RunSummaryError>([&] { read_run_summary(folder / "run.json"); });
        EXPECT_NE(message.find("run.json"), std::string::npos) << message;
    }
}

} // namespace
} // namespace meltscope
