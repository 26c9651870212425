#pragma once

#include "meltscope/scenario/scenario.hpp"

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace meltscope {

/// A scenario that cannot be used: what() is `FILE:LINE:COLUMN: KEY: what is wrong and what is allowed`.
struct ScenarioError : std::runtime_error {
    ScenarioError(std::string file_, int line_, int column_, std::string key_, const std::string& reason);
    std::string file; ///< as the caller named it; "--set KEY=VALUE" when an override is at fault
    int line;         ///< from 1; 0 when the fault has no place in a file
    int column;       ///< from 1
    std::string key;  ///< full dotted path, for example "laser[0].power"; may be empty
};

/// Reads and validates a scenario file (TOML). Files it names are found relative to its folder.
/// `overrides` are "key=value" with dotted keys ("laser.power=200 W", "laser[1].on=false",
/// "laser.NAME.power=90 W", "domain.cell_size=20 um"), applied to the file's text tree before it is
/// validated; later ones win. Throws ScenarioError on anything that is not a valid scenario.
Scenario read_scenario(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same from text; `name` stands for the file in messages, `folder` is where relative file names start.
Scenario read_scenario_text(std::string_view text, const std::vector<std::string>& overrides = {},
                            const std::string& name = "scenario", const std::filesystem::path& folder = ".");

/// Reads a material file; the material is called as the file is, without its extension.
Material read_material(const std::filesystem::path& file);

/// The scenario as TOML, complete: every default, SI numbers, materials and paths inline, file names
/// absolute. Doubles are written so that reading the text gives the same bits.
std::string to_toml(const Scenario& scenario);

/// What is different, one text a key in their order: "laser[0].power: 100 -> 250", in SI units.
std::vector<std::string> scenario_changes(const Scenario& from, const Scenario& to);

} // namespace meltscope
