#pragma once

#include "meltscope/scenario/units.hpp"
#include "meltscope/vec3.hpp"

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace meltscope {

/// A command that cannot be carried out; the message says what is wrong and what would be right.
struct CommandError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A command that only the present state of the run forbids: later it may be right.
struct NotNow : CommandError {
    using CommandError::CommandError;
};

/// Splits a line at blanks and commas. "..." and '...' keep blanks together (and are dropped), # begins a
/// comment.
/// Throws CommandError for a quote that is not closed.
std::vector<std::string> split_words(std::string_view line);

/// The word as it must be written so that split_words gives it back: in quotes if need be.
std::string as_word(std::string_view word);

/// True if the word begins as a number does.
bool looks_like_number(std::string_view word);

/// True if the word is a whole number without sign, such as a count of steps.
bool is_count(std::string_view word);

/// The words of a command, read one after another. Every reader throws CommandError naming `what` for a word
/// that is missing or wrong.
class Arguments {
  public:
    explicit Arguments(std::vector<std::string> words) : words_(std::move(words)) {}

    bool empty() const { return next_ == words_.size(); }
    /// The next word without taking it; empty at the end.
    std::string peek() const { return empty() ? std::string() : words_[next_]; }
    bool next_is_number() const { return !empty() && looks_like_number(words_[next_]); }

    std::string word(const std::string& what);
    /// Takes the next word if it is this one.
    bool take(std::string_view keyword);
    /// Takes one of `choices` or an unambiguous beginning of one.
    std::string choice(const std::string& what, const std::vector<std::string>& choices);
    /// on/off, true/false, yes/no, 1/0.
    bool on_or_off(const std::string& what);
    std::int64_t count(const std::string& what);
    /// A number in SI, or with a unit: 85e-6, 85um, 85 um, "85 um". The words of `keywords` are no units.
    double quantity(const std::string& what, const Quantity& quantity,
                    const std::vector<std::string>& keywords = {});
    /// All words that are left, put together again.
    std::string rest();
    /// Throws if a word is left.
    void done() const;

  private:
    std::vector<std::string> words_;
    std::size_t next_ = 0;
};

/// Throws CommandError unless low <= value <= high; `unit` is for the message.
void require_between(double value, double low, double high, const std::string& what, const char* unit);
/// Throws CommandError unless the value is above zero.
void require_positive(double value, const std::string& what, const char* unit);

/// The shortest text that reads back as the same double.
std::string exact(double value);
/// A value for people: six digits and an SI prefix where the unit takes one.
std::string shown(double value, std::string_view unit);

/// The only candidate that `word` begins or is. Throws CommandError that lists those it may mean, or the
/// nearest one. `kind` names what the candidates are.
std::string resolve(const std::string& word, const std::vector<std::string>& candidates,
                    const std::string& kind);

} // namespace meltscope
