#include "scenario_parts.hpp"
#include "scenario_words.hpp"

#include "meltscope/beam/path_file.hpp"
#include "meltscope/beam/pattern.hpp"

#include <fmt/format.h>

#include <cmath>

namespace meltscope {
namespace {

bool over_domain(const DomainSpec& domain, const Vec3& point) {
    return point[0] >= domain.min[0] && point[0] <= domain.max[0] && point[1] >= domain.min[1] &&
           point[1] <= domain.max[1];
}

std::string outside_text(const DomainSpec& domain, const Vec3& point) {
    return fmt::format(
        "[{:g}, {:g}] m lies outside the domain, which reaches from [{:g}, {:g}] to [{:g}, {:g}] m "
        "along x and y",
        point[0], point[1], domain.min[0], domain.min[1], domain.max[0], domain.max[1]);
}

Vec3 path_point(const Section& element, const char* key, const DomainSpec& domain) {
    const Vec3 point = element.vector(key, quantity::length);
    if (!over_domain(domain, point)) {
        element.fail(key, outside_text(domain, point));
    }
    return point;
}

std::optional<double> segment_power(const Section& element) {
    return element.has("power") ? std::optional(element.in_range("power", quantity::power, 0.0, no_limit))
                                : std::nullopt;
}

/// One element of an inline path, appended to `path`. `started` becomes true with the first point.
void read_path_element(const Section& element, const DomainSpec& domain, ScanPath& path, bool& started) {
    element.allow_only({"to", "move", "dwell", "speed", "power", "at", "on"});
    if (static_cast<int>(element.has("to")) + static_cast<int>(element.has("move")) +
            static_cast<int>(element.has("dwell")) !=
        1) {
        element.fail(
            "expected exactly one of to = [x, y, z] (a line with light), move = [x, y, z] (without light), "
            "dwell = time");
    }
    PathSegment segment;
    segment.power = segment_power(element);
    if (element.has("dwell")) {
        element.allow_only({"dwell", "power", "at", "on"});
        segment.kind = PathSegment::Kind::dwell;
        segment.duration = element.in_range("dwell", quantity::time, 0.0, no_limit);
        segment.laser_on = element.flag("on", true);
        if (!started && !element.has("at")) {
            element.fail("the path has no start yet: begin it with move = [x, y, z]");
        }
        segment.end = element.has("at") ? path_point(element, "at", domain) : path_end(path);
        if (!started) {
            path.start = segment.end;
        }
        started = true;
        path.segments.push_back(segment);
        return;
    }
    const bool lit = element.has("to");
    element.allow_only({lit ? "to" : "move", "speed", "power"});
    segment.end = path_point(element, lit ? "to" : "move", domain);
    segment.laser_on = lit;
    const std::optional<double> speed = element.maybe_above("speed", quantity::speed, 0.0);
    if (!started) {
        path.start = segment.end; // the beam begins at the first point; how it got there is of no account
        started = true;
        return;
    }
    if (lit && !speed) {
        element.fail("speed", "missing: a line with light needs its speed");
    }
    if (speed) {
        segment.kind = PathSegment::Kind::line;
        segment.speed = *speed;
        if (segment.end == path_end(path)) {
            element.fail(lit ? "to" : "move", "the beam is there already; a stay is written as dwell = time");
        }
    } else {
        segment.kind = PathSegment::Kind::dwell; // a jump is a dwell of no duration
    }
    path.segments.push_back(segment);
}

ScanPath read_inline_path(const Section& laser, const DomainSpec& domain) {
    ScanPath path;
    bool started = false;
    for (const Section& element : laser.sections("path")) {
        read_path_element(element, domain, path, started);
    }
    if (!started) {
        laser.fail("path", "is empty: it needs at least its start, {move = [x, y, z]}");
    }
    return path;
}

Eigen::Vector2d corner(const Section& section, const char* key) {
    const std::vector<double> values = section.numbers(key, quantity::length, 2, 2);
    return {values[0], values[1]};
}

ScanPath read_pattern(const Section& laser) {
    const std::vector<std::string> raster_keys{
        "type",  "min",       "max",           "z",      "hatch",           "angle",          "speed",
        "power", "turn_time", "bidirectional", "layers", "layer_thickness", "layer_rotation", "layer_pause"};
    std::vector<std::string> island_keys = raster_keys;
    island_keys.insert(island_keys.end(), {"island_size", "island_rotation", "seed"});
    const Section section = laser.section("pattern", island_keys);
    const bool islands = section.word("type", {"raster", "island"}) == "island";
    section.allow_only(islands ? island_keys : raster_keys);

    IslandSpec spec;
    RasterSpec& raster = spec.raster;
    raster.min = corner(section, "min");
    raster.max = corner(section, "max");
    raster.z = section.has("z") ? section.number("z", quantity::length) : 0.0;
    raster.hatch = section.above("hatch", quantity::length, 0.0);
    raster.angle = section.has("angle") ? section.number("angle", quantity::angle) : 0.0;
    raster.speed = section.above("speed", quantity::speed, 0.0);
    raster.power = segment_power(section);
    raster.turn_time = section.in_range("turn_time", quantity::time, 0.0, no_limit, 0.0);
    raster.bidirectional = section.flag("bidirectional", true);
    LayerSpec layers;
    layers.count = static_cast<int>(section.integer("layers", 1, 100000, 1));
    layers.thickness = section.in_range("layer_thickness", quantity::length, 0.0, no_limit, 0.0);
    layers.rotation =
        section.has("layer_rotation") ? section.number("layer_rotation", quantity::angle) : layers.rotation;
    layers.pause = section.in_range("layer_pause", quantity::time, 0.0, no_limit, 0.0);
    if (!islands) {
        return make_raster_layers(raster, layers);
    }
    spec.island_size = section.above("island_size", quantity::length, 0.0);
    spec.island_rotation =
        section.has("island_rotation") ? section.number("island_rotation", quantity::angle) : 0.0;
    spec.seed =
        static_cast<std::uint64_t>(section.integer("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
    return make_island_layers(spec, layers);
}

/// The path, from wherever it comes; whatever it is, it runs over the domain.
ScanPath read_path(const Section& laser, const DomainSpec& domain, double power) {
    const std::vector<std::string> sources{"path", "path_file", "pattern"};
    std::string source;
    for (const std::string& key : sources) {
        if (laser.has(key)) {
            if (!source.empty()) {
                laser.fail(
                    key, fmt::format("the path is given by {} already; only one of path, path_file, pattern",
                                     source));
            }
            source = key;
        }
    }
    if (source.empty()) {
        laser.fail("path", "missing: one of path, path_file, pattern is needed");
    }
    if (laser.has("path_format") && source != "path_file") {
        laser.fail("path_format", "belongs to path_file");
    }
    ScanPath path;
    try {
        if (source == "path") {
            path = read_inline_path(laser, domain);
        } else if (source == "pattern") {
            path = read_pattern(laser);
        } else {
            const PathFileFormat format = laser.choice(
                "path_format",
                {{"additivefoam", PathFileFormat::additivefoam}, {"3dthesis", PathFileFormat::threedthesis}},
                PathFileFormat::additivefoam);
            path = read_path_file(laser.file("path_file"), format, power);
        }
        path.start_time = laser.in_range("start_time", quantity::time, 0.0, no_limit, 0.0);
        check_path(path);
    } catch (const PathError& error) {
        laser.fail(source, error.what());
    }
    if (!over_domain(domain, path.start)) {
        laser.fail(source, fmt::format("the start, {}", outside_text(domain, path.start)));
    }
    for (std::size_t i = 0; i < path.segments.size(); ++i) {
        if (!over_domain(domain, path.segments[i].end)) {
            laser.fail(source, fmt::format("the end of segment {}, {}", i + 1,
                                           outside_text(domain, path.segments[i].end)));
        }
    }
    return path;
}

double read_spot_radius(const Section& section, BeamProfile profile, const DomainSpec& domain) {
    if (section.has("spot_radius") == section.has("d4sigma")) {
        section.fail("spot_radius", "exactly one of spot_radius (1/e^2) and d4sigma is needed");
    }
    const char* key = section.has("spot_radius") ? "spot_radius" : "d4sigma";
    if (section.has("d4sigma") && profile == BeamProfile::super_gaussian) {
        section.fail("d4sigma", "is not half of anything for a super-Gaussian beam; give spot_radius");
    }
    const double given = section.above(key, quantity::length, 0.0);
    const double radius = section.has("d4sigma") ? 0.5 * given : given;
    if (radius < domain.cell_size) {
        section.fail(
            key,
            fmt::format("the spot radius, {:g} m, is smaller than a cell, {:g} m; the grid cannot see it",
                        radius, domain.cell_size));
    }
    return radius;
}

Laser read_laser(const Section& section, const DomainSpec& domain, std::size_t index) {
    section.allow_only({"name", "power", "absorptivity", "spot_radius", "d4sigma", "profile",
                        "super_gaussian_order", "volume_depth", "direction", "on", "start_time", "path",
                        "path_file", "path_format", "pattern"});
    Laser laser;
    laser.name = section.has("name") ? section.text("name")
                 : index == 0        ? "laser"
                                     : fmt::format("laser{}", index + 1);
    if (laser.name.empty() ||
        laser.name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                     "0123456789_-") != std::string::npos) {
        section.fail("name", "must be of letters, digits, _ and -, since commands name the laser by it");
    }
    laser.power = section.in_range("power", quantity::power, 0.0, no_limit);
    laser.absorptivity = section.in_range("absorptivity", quantity::number, 0.0, 1.0);
    laser.profile = section.choice("profile", words::profile, BeamProfile::gaussian);
    laser.spot_radius = read_spot_radius(section, laser.profile, domain);
    if (laser.profile == BeamProfile::super_gaussian) {
        laser.super_gaussian_order =
            section.above("super_gaussian_order", quantity::number, 0.0, 100.0, laser.super_gaussian_order);
    } else if (section.has("super_gaussian_order")) {
        section.fail("super_gaussian_order", "belongs to profile = \"super_gaussian\"");
    }
    if (laser.profile == BeamProfile::volumetric) {
        if (!section.has("volume_depth")) {
            section.fail("volume_depth", "missing, and profile = \"volumetric\" needs it");
        }
        laser.volume_depth = section.above("volume_depth", quantity::length, 0.0);
    } else if (section.has("volume_depth")) {
        section.fail("volume_depth", "belongs to profile = \"volumetric\"");
    }
    laser.direction = section.direction("direction", laser.direction);
    laser.on = section.flag("on", true);
    laser.path = read_path(section, domain, laser.power);
    return laser;
}

} // namespace

std::vector<Laser> read_lasers(const Section& root, const DomainSpec& domain) {
    std::vector<Laser> lasers;
    for (const Section& section : root.sections("laser")) {
        lasers.push_back(read_laser(section, domain, lasers.size()));
        for (std::size_t i = 0; i + 1 < lasers.size(); ++i) {
            if (lasers[i].name == lasers.back().name) {
                section.fail("name", fmt::format("there is a laser called \"{}\" already", lasers[i].name));
            }
        }
    }
    return lasers;
}

} // namespace meltscope
