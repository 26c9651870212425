#include "meltscope/console/arguments.hpp"

#include "meltscope/scenario/nearest_word.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace meltscope {
namespace {

bool is_gap(char c) {
    return c == ' ' || c == '\t' || c == ',' || c == '\r';
}

std::string listed(const std::vector<std::string>& words) {
    return fmt::format("{}", fmt::join(words, ", "));
}

/// The value of a word that is a finite number and nothing else.
std::optional<double> plain_number(std::string_view word) {
    double value = 0.0;
    const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    const bool whole = error == std::errc() && end == word.data() + word.size() && std::isfinite(value);
    return whole ? std::optional(value) : std::nullopt;
}

} // namespace

std::vector<std::string> split_words(std::string_view line) {
    std::vector<std::string> words;
    std::size_t at = 0;
    while (at < line.size()) {
        if (is_gap(line[at])) {
            ++at;
            continue;
        }
        if (line[at] == '#')
            break;
        std::string word;
        while (at < line.size() && !is_gap(line[at])) {
            const char quote = line[at];
            if (quote != '"' && quote != '\'') {
                word += line[at++];
                continue;
            }
            const std::size_t close = line.find(quote, at + 1);
            if (close == std::string_view::npos)
                throw CommandError("a quote is not closed");
            word += line.substr(at + 1, close - at - 1);
            at = close + 1;
        }
        words.push_back(std::move(word));
    }
    return words;
}

std::string as_word(std::string_view word) {
    if (!word.empty() && word.find_first_of(" \t,#\"'") == std::string_view::npos)
        return std::string(word);
    std::string text = "\""; // pieces without double quotes in these, double quotes in single ones
    for (const char c : word)
        text += c == '"' ? std::string("\"'\"'\"") : std::string(1, c);
    return text + "\"";
}

bool looks_like_number(std::string_view word) {
    const std::size_t sign = word.starts_with('+') || word.starts_with('-') ? 1 : 0;
    const std::size_t digit = sign < word.size() && word[sign] == '.' ? sign + 1 : sign;
    return digit < word.size() && word[digit] >= '0' && word[digit] <= '9';
}

bool is_count(std::string_view word) {
    return !word.empty() && word.size() < 16 &&
           std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::string Arguments::word(const std::string& what) {
    if (empty())
        throw CommandError(fmt::format("{} is missing", what));
    return words_[next_++];
}

bool Arguments::take(std::string_view keyword) {
    const bool there = !empty() && words_[next_] == keyword;
    next_ += there ? 1 : 0;
    return there;
}

std::string Arguments::choice(const std::string& what, const std::vector<std::string>& choices) {
    if (empty())
        throw CommandError(fmt::format("{} is missing: one of {}", what, listed(choices)));
    return resolve(word(what), choices, what);
}

bool Arguments::on_or_off(const std::string& what) {
    const std::string given = empty() ? std::string() : word(what);
    for (const char* yes : {"on", "true", "yes", "1"})
        if (given == yes)
            return true;
    for (const char* no : {"off", "false", "no", "0"})
        if (given == no)
            return false;
    throw CommandError(fmt::format("{} is on or off, not \"{}\"", what, given));
}

std::int64_t Arguments::count(const std::string& what) {
    const std::string given = word(what);
    if (!is_count(given))
        throw CommandError(fmt::format("{} is a whole number, not \"{}\"", what, given));
    return std::stoll(given);
}

double Arguments::quantity(const std::string& what, const Quantity& quantity,
                           const std::vector<std::string>& keywords) {
    if (empty())
        throw CommandError(fmt::format("{} is missing: a {} in {}", what, quantity.name, quantity.unit));
    std::string text = words_[next_++];
    const std::optional<double> plain = plain_number(text);
    const auto is_unit = [&](const std::string& next) {
        return !looks_like_number(next) &&
               std::find(keywords.begin(), keywords.end(), next) == keywords.end();
    };
    const bool has_unit = plain && !empty() && is_unit(peek());
    const std::string unit = has_unit ? word("the unit") : std::string();
    if (plain && (!has_unit || unit == quantity.unit))
        return *plain; // SI, bit for bit
    if (has_unit)
        text = fmt::format("{} {}", text, unit);
    try {
        return to_si(text, quantity);
    } catch (const UnitError& error) {
        throw CommandError(fmt::format("{}: {}", what, error.what()));
    }
}

std::string Arguments::rest() {
    std::string text;
    for (; !empty(); ++next_)
        text += fmt::format("{}{}", text.empty() ? "" : " ", as_word(words_[next_]));
    return text;
}

void Arguments::done() const {
    if (!empty())
        throw CommandError(fmt::format("\"{}\" is more than was expected", words_[next_]));
}

void require_between(double value, double low, double high, const std::string& what, const char* unit) {
    if (!(value >= low) && std::isinf(high))
        throw CommandError(
            fmt::format("{} must be {} or more, not {}", what, shown(low, unit), shown(value, unit)));
    if (!(value >= low && value <= high))
        throw CommandError(fmt::format("{} must lie between {} and {}, not at {}", what, shown(low, unit),
                                       shown(high, unit), shown(value, unit)));
}

void require_positive(double value, const std::string& what, const char* unit) {
    if (!(value > 0.0 && std::isfinite(value)))
        throw CommandError(fmt::format("{} must be above zero, not {}", what, shown(value, unit)));
}

std::string exact(double value) {
    return fmt::format("{}", value);
}

std::string shown(double value, std::string_view unit) {
    if (unit == "1" || unit.empty())
        return fmt::format("{:.6g}", value);
    static constexpr std::array<const char*, 6> prefixes{"p", "n", "u", "m", "", "k"};
    const bool takes_prefix = unit == "m" || unit == "s" || unit == "m/s" || unit == "J";
    const double size = std::abs(value);
    if (!takes_prefix || !std::isfinite(size) || size < 1e-12 || size >= 1.0)
        return fmt::format("{:.6g} {}", value, unit);
    const double power = std::floor(std::log10(size) / 3.0 + 1e-9);
    return fmt::format("{:.6g} {}{}", value / std::pow(1000.0, power), prefixes[std::size_t(power + 4.0)],
                       unit);
}

std::string resolve(const std::string& word, const std::vector<std::string>& candidates,
                    const std::string& kind) {
    const std::string bare = kind.starts_with("the ") ? kind.substr(4) : kind;
    if (std::find(candidates.begin(), candidates.end(), word) != candidates.end())
        return word;
    std::vector<std::string> begun;
    for (const std::string& candidate : candidates)
        if (!word.empty() && candidate.starts_with(word))
            begun.push_back(candidate);
    if (begun.size() == 1)
        return begun.front();
    if (!begun.empty())
        throw CommandError(fmt::format("\"{}\" may mean {}", word, listed(begun)));
    const std::string nearest = nearest_word(word, candidates);
    if (!nearest.empty())
        throw CommandError(fmt::format("there is no {} \"{}\"; did you mean {}?", bare, word, nearest));
    throw CommandError(candidates.size() <= 12 ? fmt::format("there is no {} \"{}\"; there are {}", bare,
                                                             word, listed(candidates))
                                               : fmt::format("there is no {} \"{}\"", bare, word));
}

} // namespace meltscope
