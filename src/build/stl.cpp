#include "meltscope/build/stl.hpp"

#include "../beam/text_number.hpp"

#include <Eigen/Geometry>
#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

namespace meltscope {

namespace {

/// Corners of triangles, three for each, before equal ones are merged.
using Corners = std::vector<Vec3>;

constexpr std::size_t header_bytes = 84;   // 80 of text, 4 of the number of triangles
constexpr std::size_t triangle_bytes = 50; // normal and three corners as floats, 2 bytes of attributes

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        value |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
    }
    return value;
}

std::size_t binary_size(std::string_view bytes) {
    return header_bytes + triangle_bytes * std::size_t{little_endian(bytes, 80)};
}

Corners read_binary(std::string_view bytes) {
    Corners corners;
    corners.reserve(3 * ((bytes.size() - header_bytes) / triangle_bytes));
    for (std::size_t triangle = header_bytes; triangle < bytes.size(); triangle += triangle_bytes) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            Vec3 point;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::size_t at = triangle + 12 + 12 * corner + 4 * axis;
                point[static_cast<Eigen::Index>(axis)] = std::bit_cast<float>(little_endian(bytes, at));
            }
            corners.push_back(point);
        }
    }
    return corners;
}

/// Words of an ASCII file, with the line for messages.
class WordReader {
  public:
    WordReader(std::string_view text, std::string_view name) : text_(text), name_(name) {}

    /// The next word in lower case; empty at the end of the file.
    std::string next() {
        while (!text_.empty() && is_blank(text_.front())) {
            line_ += text_.front() == '\n' ? 1 : 0;
            text_.remove_prefix(1);
        }
        const auto end = std::find_if(text_.begin(), text_.end(), is_blank);
        std::string word(text_.begin(), end);
        text_.remove_prefix(word.size());
        std::transform(word.begin(), word.end(), word.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return word;
    }

    void skip_line() { text_.remove_prefix(std::min(text_.find('\n'), text_.size())); }

    void expect(std::string_view wanted) {
        const std::string word = next();
        if (word != wanted) {
            refuse(word, fmt::format("\"{}\"", wanted));
        }
    }

    Vec3 next_vector() {
        Vec3 vector;
        for (double& component : vector) {
            const std::string word = next();
            const std::optional<double> value = parse_number(word);
            if (!value) {
                refuse(word, "a number");
            }
            component = *value;
        }
        return vector;
    }

    [[noreturn]] void refuse(std::string_view found, std::string_view wanted) const {
        throw GeometryError(
            found.empty()
                ? fmt::format("{}:{}: the file is cut short: {} was to come", name_, line_, wanted)
                : fmt::format("{}:{}: {} was to come, not \"{}\"", name_, line_, wanted, shown(found)));
    }

  private:
    static bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

    std::string_view text_;
    std::string_view name_;
    std::size_t line_ = 1;
};

Corners read_ascii(std::string_view text, std::string_view name) {
    WordReader words(text, name);
    Corners corners;
    for (std::string word = words.next(); !word.empty(); word = words.next()) {
        if (word != "solid") {
            words.refuse(word, "\"solid\"");
        }
        words.skip_line(); // the solid's name
        for (word = words.next(); word == "facet"; word = words.next()) {
            words.expect("normal");
            words.next_vector();
            words.expect("outer");
            words.expect("loop");
            for (int corner = 0; corner < 3; ++corner) {
                words.expect("vertex");
                corners.push_back(words.next_vector());
            }
            words.expect("endloop");
            words.expect("endfacet");
        }
        if (word != "endsolid") {
            words.refuse(word, "\"facet\" or \"endsolid\"");
        }
        words.skip_line();
    }
    return corners;
}

Corners read_corners(std::string_view bytes, std::string_view name) {
    const bool says_solid = bytes.substr(0, 5) == "solid";
    const bool holds_zero = bytes.substr(0, 1024).find('\0') != std::string_view::npos;
    if (bytes.size() >= header_bytes && bytes.size() == binary_size(bytes)) {
        return read_binary(bytes); // also of files that begin with "solid", as some programs write them
    }
    if (!holds_zero && (says_solid || bytes.find("facet") != std::string_view::npos)) {
        return read_ascii(bytes, name);
    }
    if (bytes.size() < header_bytes) {
        throw GeometryError(fmt::format("{}: not an STL file: {} bytes are too few", name, bytes.size()));
    }
    throw GeometryError(
        fmt::format("{}: a binary STL file of {} triangles has {} bytes, this one has {}: it is {}", name,
                    little_endian(bytes, 80), binary_size(bytes), bytes.size(),
                    bytes.size() < binary_size(bytes) ? "cut short" : "too long"));
}

Solid merge_corners(const Corners& corners) {
    std::vector<std::uint32_t> order(corners.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        return std::lexicographical_compare(corners[a].begin(), corners[a].end(), corners[b].begin(),
                                            corners[b].end());
    };
    std::sort(order.begin(), order.end(), less);
    Solid solid;
    solid.triangles.resize(corners.size() / 3);
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || less(order[i - 1], order[i])) {
            solid.points.push_back(corners[order[i]]);
        }
        solid.triangles[order[i] / 3][order[i] % 3] = static_cast<std::uint32_t>(solid.points.size() - 1);
    }
    return solid;
}

/// A triangle's side, once for each of its two triangles.
struct Side {
    std::uint32_t low = 0;
    std::uint32_t high = 0;
    bool forward = false; // from low to high
};

std::string place_of(const Solid& solid, const Side& side) {
    const Vec3& a = solid.points[side.low];
    const Vec3& b = solid.points[side.high];
    return fmt::format("the edge from ({}, {}, {}) to ({}, {}, {}) m", a.x(), a.y(), a.z(), b.x(), b.y(),
                       b.z());
}

void check_sides(const Solid& solid) {
    std::vector<Side> sides;
    sides.reserve(3 * solid.triangles.size());
    for (const auto& triangle : solid.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t from = triangle[i];
            const std::uint32_t to = triangle[(i + 1) % 3];
            sides.push_back({std::min(from, to), std::max(from, to), from < to});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.low, a.high, a.forward) < std::tie(b.low, b.high, b.forward);
    });
    for (std::size_t i = 0; i < sides.size();) {
        std::size_t end = i;
        while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) {
            ++end;
        }
        if (end - i == 1) {
            throw GeometryError("the mesh is not closed: " + place_of(solid, sides[i]) +
                                " belongs to one triangle only");
        }
        if (end - i > 2) {
            throw GeometryError(fmt::format("the mesh is not a simple surface: {} belongs to {} triangles",
                                            place_of(solid, sides[i]), end - i));
        }
        if (sides[i].forward == sides[i + 1].forward) {
            throw GeometryError("the mesh is not oriented: both triangles run the same way along " +
                                place_of(solid, sides[i]));
        }
        i = end;
    }
}

void check_areas(const Solid& solid) {
    for (const auto& [i, j, k] : solid.triangles) {
        const Vec3 first = solid.points[j] - solid.points[i];
        const Vec3 second = solid.points[k] - solid.points[i];
        const double longest =
            std::max({first.squaredNorm(), second.squaredNorm(), (second - first).squaredNorm()});
        if (!(first.cross(second).norm() > 1e-12 * longest)) {
            const Vec3& place = solid.points[i];
            throw GeometryError(fmt::format("the triangle at ({}, {}, {}) m is degenerate: it has no area",
                                            place.x(), place.y(), place.z()));
        }
    }
}

} // namespace

void check_closed(const Solid& solid) {
    if (solid.triangles.empty()) {
        throw GeometryError("the mesh has no triangles");
    }
    check_areas(solid);
    check_sides(solid);
}

double volume(const Solid& solid) {
    if (solid.points.empty()) {
        return 0.0;
    }
    const Vec3 apex = solid.points.front(); // near the mesh, for the sake of rounding
    double sixfold = 0.0;
    for (const auto& [i, j, k] : solid.triangles) {
        sixfold += (solid.points[i] - apex).dot((solid.points[j] - apex).cross(solid.points[k] - apex));
    }
    return sixfold / 6.0;
}

Solid parse_stl(std::string_view bytes, std::string_view name, double scale) {
    if (!(std::isfinite(scale) && scale > 0.0)) {
        throw GeometryError(fmt::format("{}: the scale must be above zero, not {}", name, scale));
    }
    Corners corners = read_corners(bytes, name);
    if (corners.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw GeometryError(fmt::format("{}: {} triangles are too many", name, corners.size() / 3));
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
        corners[i] *= scale;
        if (!corners[i].allFinite()) {
            throw GeometryError(
                fmt::format("{}: triangle {} has a coordinate that is not finite", name, i / 3 + 1));
        }
    }
    Solid solid = merge_corners(corners);
    try {
        check_closed(solid);
        const double enclosed = volume(solid);
        if (enclosed == 0.0) {
            throw GeometryError("the mesh encloses no volume");
        }
        if (enclosed < 0.0) {
            for (auto& triangle : solid.triangles) {
                std::swap(triangle[1], triangle[2]);
            }
        }
    } catch (const GeometryError& error) {
        throw GeometryError(fmt::format("{}: {}", name, error.what()));
    }
    return solid;
}

Solid read_stl(const std::filesystem::path& file, double scale) {
    std::error_code ignored;
    std::ifstream stream(file, std::ios::binary);
    if (std::filesystem::is_directory(file, ignored) || !stream) {
        throw GeometryError(fmt::format("{}: the STL file cannot be opened", file.string()));
    }
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    return parse_stl(bytes, file.string(), scale);
}

} // namespace meltscope
