#include "meltscope/build/ball_file.hpp"

#include "../beam/text_number.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

namespace meltscope {

namespace {

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    const std::size_t begin = text.find_first_not_of(blanks);
    if (begin == std::string_view::npos) {
        return {};
    }
    return text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

std::vector<std::string_view> split_at_commas(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::size_t end = line.find(','); end != std::string_view::npos; end = line.find(',')) {
        words.push_back(trimmed(line.substr(0, end)));
        line.remove_prefix(end + 1);
    }
    words.push_back(trimmed(line));
    return words;
}

constexpr std::string_view columns = "xyzr";

bool is_header(const std::vector<std::string_view>& words) {
    return std::none_of(words.begin(), words.end(),
                        [](std::string_view word) { return parse_number(word).has_value(); });
}

[[noreturn]] void refuse(std::string_view name, std::size_t line, std::string_view reason) {
    throw GeometryError(fmt::format("{}:{}: {}", name, line, reason));
}

void check_header(const std::vector<std::string_view>& words, std::string_view name, std::size_t line) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (words[i].empty() || std::tolower(static_cast<unsigned char>(words[i].front())) != columns[i]) {
            refuse(name, line,
                   fmt::format("column {} of the header must be {}, not \"{}\"; the columns are x,y,z,r",
                               i + 1, columns[i], shown(words[i])));
        }
    }
}

Ball read_ball(const std::vector<std::string_view>& words, std::string_view name, std::size_t line) {
    double values[4]{};
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const std::optional<double> value = parse_number(words[i]);
        if (!value || !std::isfinite(*value)) {
            refuse(name, line,
                   fmt::format("{} must be a finite number, not \"{}\"", columns[i], shown(words[i])));
        }
        values[i] = *value;
    }
    const Ball ball{Vec3(values[0], values[1], values[2]), values[3]};
    if (!(ball.radius > 0.0)) {
        refuse(name, line, fmt::format("the radius must be above zero, not {} m", ball.radius));
    }
    return ball;
}

bool lies_outside(const Ball& ball, const Box& domain) {
    const Vec3 nearest = ball.center.cwiseMax(domain.min).cwiseMin(domain.max);
    return (ball.center - nearest).norm() >= ball.radius;
}

} // namespace

Balls parse_ball_text(std::string_view text, std::string_view name, const std::optional<Box>& domain) {
    Balls balls;
    bool first = true;
    for (std::size_t line = 1; !text.empty(); ++line) {
        const std::size_t length = std::min(text.find('\n'), text.size());
        const std::string_view content = trimmed(text.substr(0, length));
        text.remove_prefix(std::min(length + 1, text.size()));
        if (content.empty()) {
            continue;
        }
        const std::vector<std::string_view> words = split_at_commas(content);
        if (words.size() != columns.size()) {
            refuse(name, line, fmt::format("a row has 4 columns (x,y,z,r), this one has {}", words.size()));
        }
        if (first && is_header(words)) {
            check_header(words, name, line);
        } else {
            const Ball ball = read_ball(words, name, line);
            if (domain && lies_outside(ball, *domain)) {
                refuse(name, line,
                       fmt::format("the ball at ({}, {}, {}) m of radius {} m lies outside the domain",
                                   ball.center.x(), ball.center.y(), ball.center.z(), ball.radius));
            }
            balls.balls.push_back(ball);
        }
        first = false;
    }
    if (balls.balls.empty()) {
        throw GeometryError(fmt::format("{}: the file holds no ball; rows x,y,z,r are needed", name));
    }
    return balls;
}

Balls read_ball_file(const std::filesystem::path& file, const std::optional<Box>& domain) {
    std::error_code ignored;
    std::ifstream stream(file, std::ios::binary);
    if (std::filesystem::is_directory(file, ignored) || !stream) {
        throw GeometryError(fmt::format("{}: the ball list cannot be opened", file.string()));
    }
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    return parse_ball_text(text, file.string(), domain);
}

} // namespace meltscope
