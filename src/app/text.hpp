#pragma once

#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

namespace meltscope {

/// A quantity with an SI prefix and about three digits: in_si(3.6e-5, "m") is "36.0 um".
std::string in_si(double value, std::string_view unit);

/// Seconds as H:MM:SS.
std::string clock_time(double seconds);

/// Reads HH:MM:SS into seconds; nothing if it is not of that form.
std::optional<double> parse_clock_time(std::string_view text);

/// Puts the results of a command on standard output. Throws std::runtime_error if they cannot be written, as
/// to a full disk.
void print_result(const std::string& text);

/// Puts a message on standard output or error at once, if anybody is still there to read it.
void show(std::FILE* stream, const std::string& text);

} // namespace meltscope
