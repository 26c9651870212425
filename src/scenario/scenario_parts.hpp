#pragma once

#include "toml_section.hpp"

#include <string>
#include <string_view>
#include <vector>

/// The readers of a scenario's parts; each takes the section it reads and throws ScenarioError.
namespace meltscope {

/// Temperatures beyond this are slips of the pen: every metal has boiled long before (K).
inline constexpr double highest_temperature = 1e4;

/// A file's text. Throws ScenarioError if it cannot be read or is too large to be a scenario.
std::string read_text_file(const std::filesystem::path& file, const std::string& shown_name);

/// Parses TOML; every node knows `name` as its file. Throws ScenarioError for what is not TOML and for
/// nesting so deep that no scenario needs it.
toml::table parse_toml(std::string_view text, const std::string& name);

/// "laser.power=200 W" taken apart.
struct Override {
    std::string text;                    ///< as given
    std::vector<std::string> components; ///< of the key; "laser[1]" is two: "laser", "[1]"
    toml::table value;                   ///< the value under "value"
};
/// Throws ScenarioError for text that is not key=value.
Override parse_override(const std::string& text);
/// Sets the value in the tree, making tables that are not there.
void apply_override(toml::table& tree, Override change);

/// A material, from a file or inline.
Material read_material_section(const Section& section, const std::string& name);

DomainSpec read_domain(const Section& section);
/// `materials` are what a body may be made of.
std::vector<BodySpec> read_bodies(const Section& root, const DomainSpec& domain,
                                  const std::vector<Material>& materials, double ambient);
/// `end` is time.end, s; a layer without a time comes when the last laser path ends.
std::vector<ScheduledLayer> read_layers(const Section& root, const std::vector<Material>& materials,
                                        const std::vector<Laser>& lasers, double ambient, double end);
std::array<FaceSpec, 6> read_boundary(const Section& root, double ambient);
std::vector<Laser> read_lasers(const Section& root, const DomainSpec& domain);

} // namespace meltscope
