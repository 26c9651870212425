#include "meltscope/beam/path_file.hpp"
#include "meltscope/console/commands.hpp"

#include "parameter_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

/// The command `path`: what is left of a beam's way. The beam always goes on from where it is.
namespace meltscope {
namespace {

/// As path_keywords, and what only journals have.
const std::vector<std::string> keywords{"speed", "power", "off", "format", "rows"};

std::string in_mm(const Vec3& at) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g}) mm", 1e3 * at[0], 1e3 * at[1], 1e3 * at[2]);
}

/// The laser named first, or the only one; the command as the journal names it.
Laser& laser_of(Call& call, std::string& name) {
    std::vector<Laser>& lasers = call.run.simulation.parameters.lasers;
    if (lasers.empty())
        throw CommandError("the run has no laser");
    for (Laser& laser : lasers)
        if (call.arguments.take(laser.name)) {
            name = lasers.size() > 1 ? fmt::format("path {}", as_word(laser.name)) : "path";
            return laser;
        }
    if (lasers.size() > 1) {
        std::vector<std::string> names;
        for (const Laser& laser : lasers)
            names.push_back(laser.name);
        throw CommandError(fmt::format("there are several lasers: say path NAME ..., where NAME is {}",
                                       fmt::join(names, " or ")));
    }
    name = "path";
    return lasers.front();
}

Vec3 read_point(Arguments& arguments, double z) {
    const double x = arguments.quantity("x", quantity::length, keywords);
    const double y = arguments.quantity("y", quantity::length, keywords);
    return {x, y, arguments.next_is_number() ? arguments.quantity("z", quantity::length, keywords) : z};
}

std::string written(const Vec3& at) {
    return fmt::format("{} {} {}", exact(at[0]), exact(at[1]), exact(at[2]));
}

struct Options {
    std::optional<double> speed, power;
    bool off = false;

    std::string text() const {
        return (speed ? fmt::format(" speed {}", exact(*speed)) : std::string()) +
               (power ? fmt::format(" power {}", exact(*power)) : std::string()) + (off ? " off" : "");
    }
};

/// What may stand after the places and times, in any order.
Options read_options(Arguments& arguments, bool takes_speed, bool takes_light) {
    Options options;
    while (!arguments.empty()) {
        if (takes_speed && arguments.take("speed"))
            options.speed = read_scan_speed(arguments, keywords);
        else if (takes_light && arguments.take("power"))
            options.power = arguments.quantity("the power", quantity::power, keywords);
        else if (takes_light && arguments.take("off"))
            options.off = true;
        else
            arguments.done();
    }
    return options;
}

/// Puts a new path in force, unless it leaves the domain.
void put(const Run& run, Laser& laser, ScanPath path) {
    check_path(path);
    const Vec3 low = run.simulation.grid.origin, high = run.simulation.grid.upper_corner();
    for (const PathSegment& segment : path.segments)
        for (const int axis : {0, 1})
            if (segment.end[axis] < low[axis] || segment.end[axis] > high[axis])
                throw CommandError(fmt::format("{} lies outside the domain, which reaches from {} to {}",
                                               in_mm(segment.end), in_mm(low), in_mm(high)));
    laser.path = std::move(path);
}

std::string summary(const Run& run, const Laser& laser) {
    const ScanPath rest = path_from(laser.path, run.simulation.time);
    if (rest.segments.empty())
        return fmt::format("the path of {} has ended", laser.name);
    return fmt::format("{} segment{} to come until {}", rest.segments.size(),
                       rest.segments.size() == 1 ? "" : "s", shown(path_end_time(rest), "s"));
}

std::string described(const PathSegment& segment) {
    const std::string light = !segment.laser_on ? ", no light"
                              : segment.power   ? fmt::format(", {}", shown(*segment.power, "W"))
                                                : std::string();
    if (segment.kind == PathSegment::Kind::line)
        return fmt::format("line to {} at {}{}", in_mm(segment.end), shown(segment.speed, "m/s"), light);
    if (segment.duration == 0.0) // a jump
        return fmt::format("goto {}", in_mm(segment.end));
    return fmt::format("dwell at {} for {}{}", in_mm(segment.end), shown(segment.duration, "s"), light);
}

std::string show(const Run& run, const Laser& laser) {
    const double time = run.simulation.time;
    const ScanPath rest = path_from(laser.path, time);
    std::string text =
        fmt::format("beam at {}; {}", in_mm(beam_at(laser.path, time).position), summary(run, laser));
    constexpr std::size_t most = 20;
    for (std::size_t n = 0; n < std::min(most, rest.segments.size()); ++n)
        text += fmt::format("\n{:>3}  {}", n + 1, described(rest.segments[n]));
    if (rest.segments.size() > most)
        text += fmt::format("\n     and {} more", rest.segments.size() - most);
    return text;
}

std::string contents(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream || std::filesystem::is_directory(file))
        throw CommandError(fmt::format("{} cannot be read", file));
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The lines of a file in one: what a journal keeps, so that a replay needs no other file.
std::string in_one_line(const std::string& text) {
    std::string rows;
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        std::string row = text.substr(begin, end - begin);
        std::replace(row.begin(), row.end(), '"', ' ');
        std::replace(row.begin(), row.end(), '\r', ' ');
        if (row.find_first_not_of(" \t") != std::string::npos)
            rows += (rows.empty() ? "" : ";") + row;
        begin = end + 1;
    }
    return rows;
}

struct GivenPath {
    std::string file, rows, format = "additivefoam";

    std::string text() const {
        return fmt::format("{}{} rows \"{}\"", as_word(file),
                           format == "additivefoam" ? "" : fmt::format(" format {}", format), rows);
    }
};

GivenPath read_path(Arguments& arguments) {
    GivenPath given;
    given.file = arguments.word("the file");
    while (!arguments.empty()) {
        if (arguments.take("format"))
            given.format = arguments.choice("the format", {"additivefoam", "3dthesis"});
        else if (arguments.take("rows"))
            given.rows = arguments.word("the rows");
        else
            arguments.done();
    }
    if (given.rows.empty())
        given.rows = in_one_line(contents(given.file));
    return given;
}

ScanPath parsed(const GivenPath& given, const Laser& laser) {
    std::string text = given.rows;
    std::replace(text.begin(), text.end(), ';', '\n');
    const auto format =
        given.format == "3dthesis" ? PathFileFormat::threedthesis : PathFileFormat::additivefoam;
    return parse_path_text(text, given.file, format, laser.power);
}

} // namespace

const std::vector<std::string>& path_verbs() {
    static const std::vector<std::string> words{"show", "clear", "line", "dwell", "load", "append", "goto"};
    return words;
}

const std::vector<std::string>& path_keywords() {
    static const std::vector<std::string> words{"speed", "power", "off", "format"};
    return words;
}

std::string with_path_file_inlined(const std::string& line) {
    std::vector<std::string> words = split_words(line);
    const auto reads_file = [](const std::string& word) {
        const std::string_view load = "load", append = "append";
        return (word.size() > 1 && load.starts_with(word)) || (!word.empty() && append.starts_with(word));
    };
    const auto verb = std::find_if(words.begin() + 1, words.end(), reads_file);
    if (verb == words.end() || verb + 1 == words.end() || std::find(verb, words.end(), "rows") != words.end())
        return line;
    return fmt::format("{} rows \"{}\"", line, in_one_line(contents(*(verb + 1))));
}

std::string do_path(Call& call) {
    Arguments& arguments = call.arguments;
    std::string command;
    Laser& laser = laser_of(call, command);
    const double time = call.run.simulation.time;
    const std::string verb = arguments.empty() ? "show" : arguments.choice("path command", path_verbs());
    command = fmt::format("{} {}", command, verb);
    if (verb == "show") {
        arguments.done();
        return show(call.run, laser);
    }
    if (verb == "clear") {
        arguments.done();
        laser.path = path_cut_at(laser.path, time);
    } else if (verb == "load" || verb == "append") {
        const GivenPath given = read_path(arguments);
        ScanPath path = verb == "load" ? path_cut_at(laser.path, time) : path_from(laser.path, time);
        append_path(path, parsed(given, laser));
        put(call.run, laser, std::move(path));
        command = fmt::format("{} {}", command, given.text());
    } else {
        ScanPath path = path_from(laser.path, time);
        if (verb == "dwell") {
            const double duration = arguments.quantity("how long", quantity::time, keywords);
            const Options options = read_options(arguments, false, true);
            append_dwell(path, duration, options.power, !options.off);
            command += fmt::format(" {}{}", exact(duration), options.text());
        } else {
            const Vec3 to = read_point(arguments, path_end(path)[2]);
            const Options options = read_options(arguments, true, verb == "line");
            if (verb == "line") {
                if (!options.speed)
                    throw CommandError("a line needs its speed: path line X Y [Z] speed V");
                append_line(path, to, *options.speed, options.power, !options.off);
            } else {
                append_jump(path, to, options.speed);
            }
            command += fmt::format(" {}{}", written(to), options.text());
        }
        put(call.run, laser, std::move(path));
    }
    call.journal = command;
    return fmt::format("{} (step {}, t = {})", summary(call.run, laser), call.run.simulation.step,
                       shown(time, "s"));
}

} // namespace meltscope
