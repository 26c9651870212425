// Scenarios: read, judged, and written as run.toml keeps them, which must read back as the same. Lines that
// begin with `--set ` are overrides.
#include "fuzz.hpp"

#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/scenario/setup.hpp"

#include <vector>

using namespace meltscope;

namespace {

/// Files that a scenario may name.
const fuzz::Scratch& folder_with_files() {
    static const fuzz::Scratch scratch;
    static const bool filled = [] {
        scratch.file("steel.toml", "density = 8000\nsolidus = 1650\nliquidus = 1700\nlatent_heat = 2.7e5\n"
                                   "conductivity = {solid = [20], liquid = [30]}\n"
                                   "heat_capacity = {solid = [500], liquid = [700]}\nemissivity = 0.4\n");
        scratch.file("track.csv", "Mode X Y Z Power Param\n1 1e-4 1e-4 0 0 0\n0 3e-4 1e-4 0 100 0.5\n");
        scratch.file("balls.csv", "x,y,z,r\n1e-4,1e-4,1e-5,1e-5\n");
        return true;
    }();
    (void)filled;
    return scratch;
}

Scenario read(std::string_view text, const std::vector<std::string>& overrides) {
    return read_scenario_text(text, overrides, "scenario", folder_with_files().path());
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::string_view mark = "--set ";
    std::string text;
    std::vector<std::string> overrides;
    for (std::string_view rest = fuzz::text_of(data, size); !rest.empty();) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(line.size() + 1, rest.size()));
        if (line.starts_with(mark))
            overrides.emplace_back(line.substr(mark.size()));
        else
            text.append(line).append("\n");
    }
    Scenario scenario;
    if (!fuzz::is_taken<ScenarioError>([&] { scenario = read(text, overrides); }))
        return 0;
    scenario_notes(scenario);
    const std::string written = to_toml(scenario);
    // The program judges memory before anything is built.
    fuzz::is_taken<std::runtime_error, std::invalid_argument>([&] {
        const Estimate need = estimate(scenario);
        fuzz::require(need.bytes >= 0.0, "the estimate is no number");
    });
    if (!fuzz::is_taken<>([&] { scenario = read(written, {}); }))
        fuzz::finding("what was written is not read");
    fuzz::require(to_toml(scenario) == written, "what was written reads back as another");
    return 0;
}
