#include "meltscope/beam/path_file.hpp"

#include "text_number.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace meltscope {

namespace {

constexpr std::array<std::string_view, 6> column_names{"Mode", "X", "Y", "Z", "Power", "Param"};

struct Word {
    std::string_view text;
    std::size_t column = 0; // counted from one
};

/// Where a message points to.
struct Place {
    std::string_view file;
    std::size_t line = 0;
    std::size_t column = 1;

    [[noreturn]] void refuse(std::string_view reason) const {
        throw PathError(fmt::format("{}:{}:{}: {}", file, line, column, reason));
    }
};

std::vector<Word> split(std::string_view line) {
    constexpr std::string_view blanks = " \t\r";
    std::vector<Word> words;
    for (std::size_t begin = line.find_first_not_of(blanks); begin != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
        words.push_back({line.substr(begin, end - begin), begin + 1});
        begin = line.find_first_not_of(blanks, end);
    }
    return words;
}

bool is_header(const std::vector<Word>& words) {
    const std::string_view first = words.front().text.substr(0, 4);
    return first.size() == 4 && std::tolower(first[0]) == 'm' && std::tolower(first[1]) == 'o' &&
           std::tolower(first[2]) == 'd' && std::tolower(first[3]) == 'e';
}

/// Refuses a header that names the units of the other format.
void check_units(const std::vector<Word>& header, PathFileFormat format, Place place) {
    for (const Word& word : header) {
        std::string name(word.text);
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char c) { return char(std::tolower(c)); });
        const auto has = [&](std::string_view part) { return name.find(part) != std::string::npos; };
        place.column = word.column;
        if (format == PathFileFormat::additivefoam && (has("(mm)") || has("pmod")))
            place.refuse(
                fmt::format("{} belongs to a file of 3DThesis, in millimetres and shares of the laser's "
                            "power: path_format = \"3dthesis\" reads it",
                            shown(word.text)));
        if (format == PathFileFormat::threedthesis && (has("(m)") || has("(w)")))
            place.refuse(
                fmt::format("{} belongs to a file of AdditiveFOAM, in metres and watts: path_format = "
                            "\"additivefoam\" reads it",
                            shown(word.text)));
    }
}

double read_number(const Word& word, std::string_view name, Place place) {
    place.column = word.column;
    const std::optional<double> value = parse_number(word.text);
    if (!value) {
        place.refuse(fmt::format("{} must be a number, not \"{}\"", name, shown(word.text)));
    }
    if (!std::isfinite(*value)) {
        place.refuse(fmt::format("{} must be finite, not \"{}\"", name, shown(word.text)));
    }
    return *value;
}

struct Row {
    bool spot = false;
    Vec3 point = Vec3::Zero();    // m
    double power_or_factor = 0.0; // W, or a factor
    double param = 0.0;           // s, or m/s
};

Row read_row(const std::vector<Word>& words, PathFileFormat format, Place place) {
    if (words.size() != column_names.size()) {
        place.column = words.size() > column_names.size() ? words[column_names.size()].column : 1;
        place.refuse(
            fmt::format("a row has 6 columns (Mode X Y Z Power Param), this one has {}", words.size()));
    }
    std::array<double, 6> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = read_number(words[i], column_names[i], place);
    }
    if (values[0] != 0.0 && values[0] != 1.0) {
        place.column = words[0].column;
        place.refuse(fmt::format("Mode must be 0 (line) or 1 (stay), not {}", shown(words[0].text)));
    }
    Row row;
    row.spot = values[0] == 1.0;
    row.point = Vec3(values[1], values[2], values[3]);
    if (format == PathFileFormat::threedthesis) {
        row.point /= 1000.0;
    }
    row.power_or_factor = values[4];
    row.param = values[5];
    if (row.power_or_factor < 0.0) {
        place.column = words[4].column;
        place.refuse(fmt::format("Power must be zero or more, not {}", row.power_or_factor));
    }
    place.column = words[5].column;
    if (row.spot && row.param < 0.0) {
        place.refuse(fmt::format("the time of a stay must be zero or more, not {} s", row.param));
    }
    if (!row.spot && row.param <= 0.0) {
        place.refuse(fmt::format("the speed of a line must be above zero, not {} m/s", row.param));
    }
    return row;
}

std::optional<double> row_power(const Row& row, PathFileFormat format, std::optional<double> laser_power,
                                const Place& place) {
    if (row.power_or_factor == 0.0) {
        return std::nullopt; // a segment without light
    }
    if (format == PathFileFormat::additivefoam) {
        return row.power_or_factor;
    }
    if (row.power_or_factor == 1.0) {
        return std::nullopt; // the laser's own power
    }
    if (!laser_power) {
        place.refuse(fmt::format("the power factor {} needs the laser's power, which is not given",
                                 row.power_or_factor));
    }
    return row.power_or_factor * *laser_power;
}

void append_row(ScanPath& path, const Row& row, bool first, std::optional<double> power) {
    const bool lit = row.power_or_factor > 0.0;
    if (!row.spot) {
        append_line(path, row.point, row.param, power, lit);
        return;
    }
    if (first) {
        path.start = row.point;
    } else {
        append_jump(path, row.point);
    }
    if (row.param > 0.0) {
        append_dwell(path, row.param, power, lit);
    }
}

} // namespace

ScanPath parse_path_text(std::string_view text, std::string_view name, PathFileFormat format,
                         std::optional<double> laser_power) {
    ScanPath path;
    Place place{name};
    bool header_seen = false;
    bool first = true;
    while (!text.empty()) {
        const std::size_t length = std::min(text.find('\n'), text.size());
        const std::vector<Word> words = split(text.substr(0, length));
        text.remove_prefix(std::min(length + 1, text.size()));
        ++place.line;
        if (words.empty()) {
            continue;
        }
        if (!header_seen) {
            place.column = words.front().column;
            if (!is_header(words)) {
                place.refuse("the first line must be the header: Mode X Y Z Power Param");
            }
            check_units(words, format, place);
            place.column = 1;
            header_seen = true;
            continue;
        }
        const Row row = read_row(words, format, place);
        const std::optional<double> power = row_power(row, format, laser_power, place);
        try {
            append_row(path, row, first, power);
        } catch (const PathError& error) {
            place.refuse(error.what());
        }
        first = false;
    }
    if (!header_seen) {
        throw PathError(
            fmt::format("{}: the file is empty; a header and rows Mode X Y Z Power Param are needed", name));
    }
    if (first) {
        throw PathError(fmt::format("{}: the file holds no row after its header", name));
    }
    try {
        check_path(path);
    } catch (const PathError& error) {
        throw PathError(fmt::format("{}: {}", name, error.what()));
    }
    return path;
}

ScanPath read_path_file(const std::filesystem::path& file, PathFileFormat format,
                        std::optional<double> laser_power) {
    std::error_code ignored;
    std::ifstream stream(file, std::ios::binary);
    if (std::filesystem::is_directory(file, ignored) || !stream) {
        throw PathError(fmt::format("{}: the path file cannot be opened", file.string()));
    }
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (stream.bad()) {
        throw PathError(fmt::format("{}: the path file cannot be read", file.string()));
    }
    return parse_path_text(text, file.string(), format, laser_power);
}

} // namespace meltscope
