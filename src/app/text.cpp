#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <regex>
#include <stdexcept>

namespace meltscope {

std::string in_si(double value, std::string_view unit) {
    static constexpr std::array<const char*, 9> prefixes{"p", "n", "u", "m", "", "k", "M", "G", "T"};
    if (value == 0.0 || !std::isfinite(value))
        return fmt::format("{} {}", value, unit);
    // Rounded to three digits first, so that 999.9e-6 becomes 1.00e-3.
    const double rounded = std::stod(fmt::format("{:.2e}", value));
    const double power = std::clamp(std::floor(std::log10(std::abs(rounded)) / 3.0 + 1e-9), -4.0, 4.0);
    const double scaled = rounded / std::pow(1000.0, power);
    const int digits = std::abs(scaled) >= 100.0 ? 0 : std::abs(scaled) >= 10.0 ? 1 : 2;
    return fmt::format("{:.{}f} {}{}", scaled, digits, prefixes[std::size_t(power + 4.0)], unit);
}

std::string clock_time(double seconds) {
    const auto s = std::int64_t(std::llround(std::clamp(seconds, 0.0, 3.6e8)));
    return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::optional<double> parse_clock_time(std::string_view text) {
    static const std::regex form(R"((\d{1,5}):([0-5]\d):([0-5]\d))");
    std::match_results<std::string_view::const_iterator> match;
    if (!std::regex_match(text.begin(), text.end(), match, form))
        return std::nullopt;
    return 3600.0 * std::stoi(match[1]) + 60.0 * std::stoi(match[2]) + std::stoi(match[3]);
}

void print_result(const std::string& text) {
    if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0)
        throw std::runtime_error(fmt::format("standard output: {}", std::strerror(errno)));
}

void show(std::FILE* stream, const std::string& text) {
    static_cast<void>(std::fputs(text.c_str(), stream));
    static_cast<void>(std::fflush(stream));
}

} // namespace meltscope
