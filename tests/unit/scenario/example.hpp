#pragma once

#include "meltscope/scenario/scenario_file.hpp"

#include <gtest/gtest.h>

#include <string>

/// A small valid scenario whose parts tests replace.
namespace meltscope::test {

inline const std::string example = R"(title = "example"

[domain]
min = [0, 0, "-100 um"]
max = ["400 um", "200 um", "20 um"]
cell_size = "10 um"

[material.steel]
density = 8000
solidus = 1650
liquidus = 1700
latent_heat = 2.7e5
conductivity = {solid = [20], liquid = [30]}
heat_capacity = {solid = [500], liquid = [700]}

[[body]]
shape = "box"
material = "steel"
min = [0, 0, "-100 um"]
max = ["400 um", "200 um", 0]

[boundary]
z_min = {temperature = 300}

[[laser]]
power = "100 W"
absorptivity = 0.4
spot_radius = "50 um"
path = [{move = ["100 um", "100 um", 0]}, {to = ["300 um", "100 um", 0], speed = "0.5 m/s"}]

[physics]
radiation = false

[time]
end = "1 ms"

[output]
every = "50 us"

[render]
views = ["overview"]

[checkpoint]
keep = 3
)";

/// The example with `old_text` replaced by `new_text`; fails the test if it does not occur.
inline std::string with(const std::string& old_text, const std::string& new_text,
                        const std::string& text = example) {
    const auto at = text.find(old_text);
    if (at == std::string::npos) {
        ADD_FAILURE() << "the example has no " << old_text;
        return text;
    }
    std::string result = text;
    return result.replace(at, old_text.size(), new_text);
}

/// What reading the text complains about; empty if it is accepted.
inline std::string complaint(const std::string& text, const std::vector<std::string>& overrides = {},
                             const std::filesystem::path& folder = ".") {
    try {
        read_scenario_text(text, overrides, "track.toml", folder);
    } catch (const ScenarioError& error) {
        return error.what();
    }
    return {};
}

} // namespace meltscope::test
