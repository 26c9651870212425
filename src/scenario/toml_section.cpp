#include "toml_section.hpp"

#include "meltscope/scenario/nearest_word.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

constexpr std::string_view override_mark = "--set ";

std::string message(const std::string& file, int line, int column, const std::string& key,
                    const std::string& reason) {
    std::string text = file;
    if (line > 0) {
        text += fmt::format(":{}:{}", line, column);
    }
    return text + ": " + (key.empty() ? "" : key + ": ") + reason;
}

[[noreturn]] void fail_in(const ReadContext& context, const toml::source_region& place,
                          const std::string& key, const std::string& reason) {
    const std::string file = place.path ? *place.path : context.name;
    const bool from_override = std::string_view(file).starts_with(override_mark);
    const bool placed = !from_override && place.begin;
    throw ScenarioError(file, placed ? static_cast<int>(place.begin.line) : 0,
                        placed ? static_cast<int>(place.begin.column) : 0, key, reason);
}

/// The first place found in the node or, for tables that overrides made, in what it holds.
toml::source_region place_of(const toml::node& node) {
    if (node.source().path || node.source().begin) {
        return node.source();
    }
    if (const toml::table* table = node.as_table()) {
        for (const auto& [key, child] : *table) {
            if (const toml::source_region place = place_of(child); place.path) {
                return place;
            }
        }
    }
    return {};
}

std::string type_name(const toml::node& node) {
    switch (node.type()) {
    case toml::node_type::table:
        return "a table";
    case toml::node_type::array:
        return "a list";
    case toml::node_type::string:
        return "text";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
        return "a number";
    case toml::node_type::boolean:
        return "true or false";
    default:
        return "a date or time";
    }
}

/// `did you mean "power"? allowed: name, power`, without the question if nothing is like the word.
std::string choices(std::string_view word, const std::vector<std::string>& allowed) {
    const std::string nearest = nearest_word(word, allowed);
    return fmt::format("{}allowed: {}", nearest.empty() ? "" : fmt::format("did you mean \"{}\"? ", nearest),
                       fmt::join(allowed, ", "));
}

std::string range_text(double low, bool open, double high) {
    const std::string from = fmt::format("{} {:g}", open ? "above" : "at least", low);
    return high < no_limit ? fmt::format("{} and at most {:g}", from, high) : from;
}

} // namespace

ScenarioError::ScenarioError(std::string file_, int line_, int column_, std::string key_,
                             const std::string& reason)
    : std::runtime_error(message(file_, line_, column_, key_, reason)), file(std::move(file_)), line(line_),
      column(column_), key(std::move(key_)) {}

void fail_at(const ReadContext& context, const toml::node& node, const std::string& key,
             const std::string& reason) {
    fail_in(context, place_of(node), key, reason);
}

std::string joined_key(const std::string& path, std::string_view key) {
    return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

void Section::allow_only(const std::vector<std::string>& allowed) const {
    for (const auto& [key, node] : *table_) {
        if (std::find(allowed.begin(), allowed.end(), key.str()) == allowed.end()) {
            fail_in(*context_, key.source().path ? key.source() : place_of(node),
                    joined_key(path_, key.str()), "unknown key; " + choices(key.str(), allowed));
        }
    }
}

const toml::node& Section::require(std::string_view key) const {
    if (const toml::node* node = find(key)) {
        return *node;
    }
    fail(key, "missing");
}

void Section::fail(std::string_view key, const std::string& reason) const {
    const toml::node* node = find(key);
    fail_at(*context_, node != nullptr ? *node : *table_, joined_key(path_, key), reason);
}

void Section::fail(const std::string& reason) const {
    fail_at(*context_, *table_, path_, reason);
}

double Section::as_number(const toml::node& node, const std::string& key, const Quantity& quantity) const {
    double value = 0.0;
    if (const auto* floating = node.as_floating_point()) {
        value = floating->get();
    } else if (const auto* whole = node.as_integer()) {
        value = static_cast<double>(whole->get());
    } else if (const auto* text = node.as_string()) {
        try {
            return to_si(text->get(), quantity);
        } catch (const UnitError& error) {
            fail_at(*context_, node, key, error.what());
        }
    } else {
        const bool plain = std::string_view(quantity.unit) == "1";
        fail_at(*context_, node, key,
                fmt::format("expected a {}{}, found {}", quantity.name,
                            plain ? ""
                                  : fmt::format(" (a number in {} or text such as \"1.5 {}\")", quantity.unit,
                                                quantity.unit),
                            type_name(node)));
    }
    if (!std::isfinite(value)) {
        fail_at(*context_, node, key, "must be finite");
    }
    return value;
}

double Section::number(std::string_view key, const Quantity& quantity) const {
    return as_number(require(key), joined_key(path_, key), quantity);
}

double Section::in_range(std::string_view key, const Quantity& quantity, double low, double high,
                         std::optional<double> fallback) const {
    if (fallback && !has(key)) {
        return *fallback;
    }
    const double value = number(key, quantity);
    if (!(value >= low && value <= high)) {
        fail(key, fmt::format("must be {}, is {:g}", range_text(low, false, high), value));
    }
    return value;
}

double Section::above(std::string_view key, const Quantity& quantity, double low, double high,
                      std::optional<double> fallback) const {
    if (fallback && !has(key)) {
        return *fallback;
    }
    const double value = number(key, quantity);
    if (!(value > low && value <= high)) {
        fail(key, fmt::format("must be {}, is {:g}", range_text(low, true, high), value));
    }
    return value;
}

std::optional<double> Section::maybe_above(std::string_view key, const Quantity& quantity, double low,
                                           double high) const {
    return has(key) ? std::optional(above(key, quantity, low, high)) : std::nullopt;
}

std::int64_t Section::integer(std::string_view key, std::int64_t low, std::int64_t high,
                              std::optional<std::int64_t> fallback) const {
    if (fallback && !has(key)) {
        return *fallback;
    }
    const toml::node& node = require(key);
    const auto* value = node.as_integer();
    if (value == nullptr) {
        fail(key, fmt::format("expected a whole number, found {}", type_name(node)));
    }
    if (value->get() < low || value->get() > high) {
        const std::string limit =
            high < std::numeric_limits<std::int64_t>::max() ? fmt::format(" and at most {}", high) : "";
        fail(key, fmt::format("must be at least {}{}, is {}", low, limit, value->get()));
    }
    return value->get();
}

bool Section::flag(std::string_view key, bool fallback) const {
    const toml::node* node = find(key);
    if (node == nullptr) {
        return fallback;
    }
    if (const auto* value = node->as_boolean()) {
        return value->get();
    }
    fail(key, fmt::format("expected true or false, found {}", type_name(*node)));
}

std::string Section::as_text(const toml::node& node, const std::string& key) const {
    if (const auto* value = node.as_string()) {
        return value->get();
    }
    fail_at(*context_, node, key, fmt::format("expected text, found {}", type_name(node)));
}

std::string Section::as_word(const toml::node& node, const std::string& key,
                             const std::vector<std::string>& allowed) const {
    const std::string chosen = as_text(node, key);
    if (std::find(allowed.begin(), allowed.end(), chosen) == allowed.end()) {
        fail_at(*context_, node, key,
                fmt::format("\"{}\" is not known; {}", chosen, choices(chosen, allowed)));
    }
    return chosen;
}

std::string Section::text(std::string_view key) const {
    return as_text(require(key), joined_key(path_, key));
}

std::string Section::word(std::string_view key, const std::vector<std::string>& allowed) const {
    return as_word(require(key), joined_key(path_, key), allowed);
}

const toml::array& Section::list(std::string_view key, const char* of_what) const {
    const toml::node& node = require(key);
    if (const toml::array* list = node.as_array()) {
        return *list;
    }
    fail(key, fmt::format("expected a list of {}, found {}", of_what, type_name(node)));
}

std::vector<std::string> Section::words(std::string_view key, const std::vector<std::string>& allowed) const {
    const toml::array& given = list(key, "words");
    std::vector<std::string> result;
    for (std::size_t i = 0; i < given.size(); ++i) {
        const std::string element = fmt::format("{}[{}]", joined_key(path_, key), i);
        const std::string word = as_word(given[i], element, allowed);
        if (std::find(result.begin(), result.end(), word) != result.end()) {
            fail_at(*context_, given[i], element, fmt::format("\"{}\" stands there twice", word));
        }
        result.push_back(word);
    }
    return result;
}

std::vector<double> Section::numbers(std::string_view key, const Quantity& quantity, std::size_t fewest,
                                     std::size_t most) const {
    const std::string count =
        fewest == most ? fmt::format("{} numbers", fewest) : fmt::format("{} to {} numbers", fewest, most);
    const toml::array& given = list(key, count.c_str());
    if (given.size() < fewest || given.size() > most) {
        fail(key, fmt::format("expected a list of {}, found {}", count, given.size()));
    }
    std::vector<double> values;
    for (std::size_t i = 0; i < given.size(); ++i) {
        values.push_back(as_number(given[i], fmt::format("{}[{}]", joined_key(path_, key), i), quantity));
    }
    return values;
}

Vec3 Section::vector(std::string_view key, const Quantity& quantity) const {
    const std::vector<double> values = numbers(key, quantity, 3, 3);
    return {values[0], values[1], values[2]};
}

Vec3 Section::direction(std::string_view key, const Vec3& fallback) const {
    if (!has(key)) {
        return fallback;
    }
    const Vec3 given = vector(key, quantity::number);
    const double largest = given.cwiseAbs().maxCoeff();
    if (largest == 0.0) {
        fail(key, "must not be zero: it is a direction");
    }
    // Dividing a unit vector by its length once more would change its last bits.
    if (std::abs(given.squaredNorm() - 1.0) < 1e-14) {
        return given;
    }
    return (given / largest).normalized();
}

std::filesystem::path Section::as_file(const toml::node& node, const std::string& key) const {
    const std::string name = as_text(node, key);
    if (name.empty() || name.find('\0') != std::string::npos) {
        fail_at(*context_, node, key, "is not a file name");
    }
    const std::filesystem::path found = (context_->folder / name).lexically_normal();
    std::error_code error;
    if (!std::filesystem::is_regular_file(found, error)) {
        fail_at(*context_, node, key, fmt::format("there is no file {}", found.string()));
    }
    return found;
}

std::filesystem::path Section::file(std::string_view key) const {
    return std::filesystem::absolute(as_file(require(key), joined_key(path_, key)));
}

std::vector<std::filesystem::path> Section::files(std::string_view key) const {
    const toml::array& given = list(key, "file names");
    std::vector<std::filesystem::path> result;
    for (std::size_t i = 0; i < given.size(); ++i) {
        result.push_back(as_file(given[i], fmt::format("{}[{}]", joined_key(path_, key), i)));
    }
    return result;
}

const toml::table& Section::table(std::string_view key) const {
    return as_table(require(key), joined_key(path_, key));
}

const toml::table& Section::as_table(const toml::node& node, const std::string& key) const {
    if (const toml::table* table = node.as_table()) {
        return *table;
    }
    fail_at(*context_, node, key, fmt::format("expected a table, found {}", type_name(node)));
}

Section Section::section(std::string_view key, const std::vector<std::string>& allowed) const {
    static const toml::table nothing;
    const toml::node* node = find(key);
    const std::string path = joined_key(path_, key);
    const Section result(*context_, node != nullptr ? as_table(*node, path) : nothing, path);
    result.allow_only(allowed);
    return result;
}

std::vector<Section> Section::sections(std::string_view key) const {
    std::vector<Section> result;
    const toml::node* node = find(key);
    if (node == nullptr) {
        return result;
    }
    const std::string path = joined_key(path_, key);
    const toml::array* list = node->as_array();
    if (list == nullptr) {
        fail(key, node->is_table() && path_.empty()
                      ? fmt::format("there can be several: write [[{}]]", key)
                      : fmt::format("expected a list of tables, found {}", type_name(*node)));
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
        const std::string element = fmt::format("{}[{}]", path, i);
        result.emplace_back(*context_, as_table((*list)[i], element), element);
    }
    return result;
}

} // namespace meltscope
