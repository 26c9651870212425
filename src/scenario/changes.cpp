#include "scenario_parts.hpp"

#include "meltscope/scenario/scenario_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

namespace meltscope {
namespace {

constexpr std::size_t longest_shown = 40; ///< characters of a value; of longer ones only the key is told

/// Values by their keys, written as --set takes them: "laser[0].power".
using Values = std::map<std::string, std::string>;

void collect(const toml::node& node, const std::string& key, Values& values) {
    if (const toml::table* table = node.as_table()) {
        for (const auto& [name, child] : *table)
            collect(child, key.empty() ? std::string(name.str()) : fmt::format("{}.{}", key, name.str()),
                    values);
        return;
    }
    const toml::array* list = node.as_array();
    if (list != nullptr && !list->empty() && list->is_homogeneous<toml::table>()) {
        for (std::size_t n = 0; n < list->size(); ++n)
            collect((*list)[n], fmt::format("{}[{}]", key, n), values);
        return;
    }
    if (const auto* number = node.as_floating_point()) {
        values[key] = fmt::format("{}", number->get()); // the shortest text, as people write it
        return;
    }
    std::ostringstream text;
    text << toml::toml_formatter{toml::table{{"v", node}}};
    values[key] = text.str().substr(std::string_view("v = ").size());
}

Values values_of(const Scenario& scenario) {
    Values values;
    collect(parse_toml(to_toml(scenario), "scenario"), "", values);
    return values;
}

std::string shown(const Values& values, const std::string& key) {
    const auto found = values.find(key);
    return found == values.end() ? "not set" : found->second;
}

} // namespace

std::vector<std::string> scenario_changes(const Scenario& from, const Scenario& to) {
    const Values before = values_of(from), after = values_of(to);
    Values either = before;
    either.insert(after.begin(), after.end());
    std::vector<std::string> changes;
    for (const auto& [key, value] : either) {
        const std::string was = shown(before, key), is = shown(after, key);
        if (was == is)
            continue;
        const bool is_short = std::max(was.size(), is.size()) <= longest_shown;
        changes.push_back(is_short ? fmt::format("{}: {} -> {}", key, was, is)
                                   : fmt::format("{}: another", key));
    }
    return changes;
}

} // namespace meltscope
