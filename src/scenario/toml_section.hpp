#pragma once

#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/scenario/units.hpp"

#include <toml++/toml.h>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meltscope {

/// Upper end of a range that has none.
inline constexpr double no_limit = std::numeric_limits<double>::max();

/// What the readers of one scenario share.
struct ReadContext {
    std::string name;             ///< of the file, for messages without a place
    std::filesystem::path folder; ///< where relative file names start
};

/// Throws ScenarioError with the place of `node` (of the nearest inner node that has one, else just the
/// file).
[[noreturn]] void fail_at(const ReadContext& context, const toml::node& node, const std::string& key,
                          const std::string& reason);

/// `table[key]` in the spelling of messages and overrides.
std::string joined_key(const std::string& path, std::string_view key);

/// One table of a scenario. Reads typed values and turns every mistake into a ScenarioError that has the
/// place and the full key. Refers to the tree, does not own it.
class Section {
  public:
    Section(const ReadContext& context, const toml::table& table, std::string path)
        : context_(&context), table_(&table), path_(std::move(path)) {}

    /// Refuses the first key that is not among `allowed`, with the nearest that is.
    void allow_only(const std::vector<std::string>& allowed) const;

    const std::string& path() const { return path_; }
    const ReadContext& context() const { return *context_; }
    bool has(std::string_view key) const { return table_->contains(key); }
    const toml::node* find(std::string_view key) const { return table_->get(key); }
    /// The node, or an error that the key is missing.
    const toml::node& require(std::string_view key) const;

    double number(std::string_view key, const Quantity& quantity) const;
    /// A number in [low, high] or (low, high]; an open lower end is written with `above`.
    double in_range(std::string_view key, const Quantity& quantity, double low, double high,
                    std::optional<double> fallback = {}) const;
    double above(std::string_view key, const Quantity& quantity, double low, double high = no_limit,
                 std::optional<double> fallback = {}) const;
    std::optional<double> maybe_above(std::string_view key, const Quantity& quantity, double low,
                                      double high = no_limit) const;
    std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high,
                         std::optional<std::int64_t> fallback = {}) const;
    bool flag(std::string_view key, bool fallback) const;
    std::string text(std::string_view key) const;
    /// Text that is one of `allowed`.
    std::string word(std::string_view key, const std::vector<std::string>& allowed) const;
    /// A list of such, none of them twice.
    std::vector<std::string> words(std::string_view key, const std::vector<std::string>& allowed) const;
    std::vector<double> numbers(std::string_view key, const Quantity& quantity, std::size_t fewest,
                                std::size_t most) const;
    Vec3 vector(std::string_view key, const Quantity& quantity) const;
    /// A vector of length one along what is given; a vector that has length one already keeps its bits.
    Vec3 direction(std::string_view key, const Vec3& fallback) const;
    /// An existing regular file, absolute.
    std::filesystem::path file(std::string_view key) const;
    /// A list of existing regular files, relative ones starting at the context's folder.
    std::vector<std::filesystem::path> files(std::string_view key) const;
    /// The tree under `key`.
    const toml::table& table(std::string_view key) const;

    /// The value that the word at `key` stands for, or `fallback` if there is no such key.
    template <class E>
    E choice(std::string_view key, const std::vector<std::pair<std::string, E>>& meanings, E fallback) const {
        if (!has(key)) {
            return fallback;
        }
        std::vector<std::string> words;
        for (const auto& meaning : meanings) {
            words.push_back(meaning.first);
        }
        const std::string chosen = word(key, words);
        for (const auto& [meaning, value] : meanings) {
            if (meaning == chosen) {
                return value;
            }
        }
        return fallback; // not reached: word() refuses all else
    }

    /// The table at `key`, with no other keys than `allowed`; an empty one if there is none.
    Section section(std::string_view key, const std::vector<std::string>& allowed) const;
    /// The tables of the list at `key`, their keys unchecked; none if there is no such key.
    std::vector<Section> sections(std::string_view key) const;

    /// Throws with the place of the key's value, or of the table where the key is missing.
    [[noreturn]] void fail(std::string_view key, const std::string& reason) const;
    /// The same about the table itself.
    [[noreturn]] void fail(const std::string& reason) const;

  private:
    const toml::table& as_table(const toml::node& node, const std::string& key) const;
    std::string as_text(const toml::node& node, const std::string& key) const;
    std::string as_word(const toml::node& node, const std::string& key,
                        const std::vector<std::string>& allowed) const;
    std::filesystem::path as_file(const toml::node& node, const std::string& key) const;
    const toml::array& list(std::string_view key, const char* of_what) const;
    double as_number(const toml::node& node, const std::string& key, const Quantity& quantity) const;

    const ReadContext* context_;
    const toml::table* table_;
    std::string path_;
};

} // namespace meltscope
