#pragma once

#include <cctype>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace meltscope {

/// The number that a word spells, whatever the locale; none unless all of it is one. May be infinite or not a
/// number.
inline std::optional<double> parse_number(std::string_view word) {
    if (word.size() > 1 && word.front() == '+' && word[1] != '-') {
        word.remove_prefix(1); // from_chars does not take a plus sign
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) {
        return std::nullopt;
    }
    return value;
}

/// A word as a message may show it: damaged files hold long or unprintable ones.
inline std::string shown(std::string_view word) {
    std::string result(word.substr(0, 40));
    for (char& c : result) {
        if (!std::isprint(static_cast<unsigned char>(c))) {
            c = '?';
        }
    }
    return result;
}

} // namespace meltscope
