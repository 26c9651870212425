#include "scenario_parts.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace meltscope {
namespace {

constexpr std::uintmax_t largest_file = 256u << 20; // bytes; a path of a million segments fits
constexpr int deepest_nesting = 32;                 // a scenario needs five

/// Refuses brackets or dotted keys nested deeper than any scenario: the tree is built and freed recursively,
/// and a hostile file must not exhaust the stack. Strings and comments are stepped over.
class NestingGuard {
  public:
    NestingGuard(std::string_view text, const std::string& name) : text_(text), name_(name) {}

    void check() {
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '#') {
                const auto end = text_.find('\n', at_);
                at_ = end == std::string_view::npos ? text_.size() : end;
            } else if (c == '"' || c == '\'') {
                skip_string(c);
            } else {
                count(c);
                ++at_;
            }
        }
    }

  private:
    void count(char c) {
        if (c == '\n') {
            ++line_;
            line_start_ = at_ + 1;
        }
        if (c == '[' || c == '{') {
            ++brackets_;
        } else if ((c == ']' || c == '}') && brackets_ > 0) {
            --brackets_;
        }
        if (c == '.') {
            ++dots_;
        } else if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) {
            dots_ = 0;
        }
        if (brackets_ > deepest_nesting || dots_ > deepest_nesting) {
            throw ScenarioError(
                name_, line_, static_cast<int>(at_ - line_start_) + 1, "",
                fmt::format("nested more than {} deep; a scenario needs five", deepest_nesting));
        }
    }

    void skip_string(char quote) {
        const std::string triple(3, quote);
        const bool multiline = text_.substr(at_).starts_with(triple);
        at_ += multiline ? 3 : 1;
        while (at_ < text_.size()) {
            if (quote == '"' && text_[at_] == '\\') {
                ++at_;
            } else if (multiline && text_.substr(at_).starts_with(triple)) {
                at_ += 3;
                return;
            } else if (!multiline && text_[at_] == quote) {
                ++at_;
                return;
            }
            if (at_ < text_.size() && text_[at_] == '\n') {
                ++line_;
                line_start_ = at_ + 1;
                if (!multiline) {
                    return; // unterminated; the parser will say so
                }
            }
            ++at_;
        }
    }

    std::string_view text_;
    const std::string& name_;
    std::size_t at_ = 0;
    std::size_t line_start_ = 0;
    int line_ = 1;
    int brackets_ = 0;
    int dots_ = 0;
};

} // namespace

std::string read_text_file(const std::filesystem::path& file, const std::string& shown_name) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) {
        throw ScenarioError(shown_name, 0, 0, "", "there is no such file");
    }
    if (!std::filesystem::is_regular_file(status)) {
        throw ScenarioError(shown_name, 0, 0, "", "is not a regular file");
    }
    if (std::filesystem::file_size(file, error) > largest_file || error) {
        throw ScenarioError(shown_name, 0, 0, "", fmt::format("is larger than {} MiB", largest_file >> 20));
    }
    std::ifstream stream(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) {
        throw ScenarioError(shown_name, 0, 0, "", fmt::format("cannot be read: {}", std::strerror(errno)));
    }
    return text;
}

toml::table parse_toml(std::string_view text, const std::string& name) {
    NestingGuard(text, name).check();
    try {
        return toml::parse(text, name);
    } catch (const toml::parse_error& error) {
        const toml::source_position place = error.source().begin;
        throw ScenarioError(name, static_cast<int>(place.line), static_cast<int>(place.column), "",
                            fmt::format("not valid TOML: {}", error.description()));
    }
}

} // namespace meltscope
