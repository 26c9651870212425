#include "scenario_parts.hpp"

#include <fmt/format.h>

#include <charconv>

namespace meltscope {
namespace {

[[noreturn]] void fail_override(const std::string& text, const std::string& key, const std::string& reason) {
    throw ScenarioError("--set " + text, 0, 0, key, reason);
}

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    return first == std::string_view::npos ? std::string_view()
                                           : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// "a[1].b" -> "a", "[1]", "b"; a component may be quoted, as in TOML.
std::vector<std::string> split_key(const std::string& text, std::string_view key) {
    std::vector<std::string> components;
    std::size_t at = 0;
    bool wants_name = true;
    while (at < key.size()) {
        if (key[at] == '[') {
            const auto end = key.find(']', at);
            if (wants_name || end == std::string_view::npos) {
                fail_override(text, std::string(key), "a list index is written as laser[0]");
            }
            components.emplace_back(key.substr(at, end - at + 1));
            at = end + 1;
            continue;
        }
        if (!wants_name) {
            if (key[at] != '.') {
                fail_override(text, std::string(key), "parts of a key are parted by dots, as in laser.power");
            }
            ++at;
        }
        std::size_t end = 0;
        if (at < key.size() && key[at] == '"') {
            end = key.find('"', at + 1);
            if (end == std::string_view::npos) {
                fail_override(text, std::string(key), "a quotation mark is missing");
            }
            components.emplace_back(key.substr(at + 1, end - at - 1));
            ++end;
        } else {
            end = std::min(key.find_first_of(".[", at), key.size());
            components.emplace_back(key.substr(at, end - at));
        }
        if (components.back().empty()) {
            fail_override(text, std::string(key), "a part of the key is empty");
        }
        at = end;
        wants_name = false;
    }
    if (components.empty() || components.size() > 16) {
        fail_override(text, std::string(key), "expected KEY=VALUE with a key such as laser.power");
    }
    return components;
}

std::string as_toml_string(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            result += '\\';
            result += c;
        } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
            result += fmt::format("\\u{:04x}", static_cast<int>(c));
        } else {
            result += c;
        }
    }
    return result + "\"";
}

/// TOML where it is TOML, else text, so that units need no quotation marks: power=200 W.
toml::table parse_value(const std::string& text, std::string_view value) {
    const std::string name = "--set " + text;
    if (value.find('\n') == std::string_view::npos) {
        try {
            return parse_toml(fmt::format("value = {}", value), name);
        } catch (const ScenarioError&) {
            if (!value.empty() && std::string_view("[{\"'").find(value[0]) != std::string_view::npos) {
                fail_override(text, "", "the value is not valid TOML");
            }
        }
    }
    return parse_toml(fmt::format("value = {}", as_toml_string(value)), name);
}

std::string spelled(const std::vector<std::string>& components, std::size_t count) {
    std::string result;
    for (std::size_t i = 0; i < count; ++i) {
        result += components[i][0] == '[' || i == 0 ? components[i] : "." + components[i];
    }
    return result;
}

std::vector<std::string> names_in(const toml::array& list) {
    std::vector<std::string> names;
    for (const toml::node& element : list) {
        if (const toml::table* table = element.as_table()) {
            names.push_back((*table)["name"].value_or(std::string()));
        }
    }
    return names;
}

/// Which element of a list component `i` means: by index, by name, or the only one there is.
/// Advances `i` past what named it.
std::size_t element_index(const toml::array& list, const Override& change, std::size_t& i) {
    const std::string& component = change.components[i];
    const std::string list_key = spelled(change.components, i);
    if (component[0] == '[') {
        std::size_t index = 0;
        const char* end = component.data() + component.size() - 1;
        const auto [rest, error] = std::from_chars(component.data() + 1, end, index);
        if (error != std::errc() || rest != end || index >= list.size()) {
            fail_override(change.text, list_key + component,
                          list.empty() ? "the list is empty"
                                       : fmt::format("the list has [0] to [{}]", list.size() - 1));
        }
        ++i;
        return index;
    }
    const std::vector<std::string> names = names_in(list);
    for (std::size_t k = 0; k < names.size(); ++k) {
        if (!names[k].empty() && names[k] == component && i + 1 < change.components.size()) {
            ++i;
            return k;
        }
    }
    if (list.size() == 1) {
        return 0;
    }
    std::string choices = fmt::format("{}[0] to {}[{}]", list_key, list_key, list.size() - 1);
    for (const std::string& name : names) {
        choices += name.empty() ? "" : fmt::format(", {}.{}", list_key, name);
    }
    fail_override(change.text, spelled(change.components, change.components.size()),
                  list.empty() ? fmt::format("the list {} is empty", list_key)
                               : fmt::format("which one? There are {}", choices));
}

} // namespace

Override parse_override(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos) {
        fail_override(text, "", "expected KEY=VALUE, for example laser.power=200 W");
    }
    const std::string_view all(text);
    const std::string_view value = trimmed(all.substr(equals + 1));
    if (value.empty()) {
        fail_override(text, "", "the value is missing");
    }
    return {text, split_key(text, trimmed(all.substr(0, equals))), parse_value(text, value)};
}

void apply_override(toml::table& tree, Override change) {
    const std::vector<std::string>& components = change.components;
    const std::string key = spelled(components, components.size());
    toml::node* here = &tree;
    std::size_t i = 0;
    while (true) {
        if (toml::array* list = here->as_array()) {
            const std::size_t index = element_index(*list, change, i);
            if (i == components.size()) {
                change.value.get("value")->visit([&](auto& value) {
                    list->replace(list->cbegin() + static_cast<std::ptrdiff_t>(index), std::move(value));
                });
                return;
            }
            here = &(*list)[index];
            continue;
        }
        toml::table* table = here->as_table();
        if (table == nullptr || components[i][0] == '[') {
            fail_override(
                change.text, key,
                fmt::format("{} is not a {}", spelled(components, i), table == nullptr ? "table" : "list"));
        }
        if (i + 1 == components.size()) {
            change.value.get("value")->visit(
                [&](auto& value) { table->insert_or_assign(components[i], std::move(value)); });
            return;
        }
        if (!table->contains(components[i])) {
            table->insert(components[i], toml::table{});
        }
        here = table->get(components[i]);
        ++i;
    }
}

} // namespace meltscope
