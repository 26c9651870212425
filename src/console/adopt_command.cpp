#include "meltscope/console/commands.hpp"
#include "meltscope/console/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <regex>

/// The command `adopt`: the run goes on under its scenario with some keys changed, as a restart does.
namespace meltscope {
namespace {

/// Sixteen hexadecimal digits that tell scenarios apart: FNV-1a, 64 bits (Fowler, Noll, Vo 1991).
std::string fingerprint(std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : text)
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return fmt::format("{:016x}", hash);
}

/// Whether the change has the scenario read another file, which may not be the same when it is replayed.
bool names_a_file(const std::string& change) {
    static const std::regex words(R"(\b((path_)?file|materials)\b)");
    return std::regex_search(change, words);
}

std::vector<std::pair<std::string, std::string>> shown_values(const ConsoleState& console, const Run& run) {
    std::vector<std::pair<std::string, std::string>> all;
    for (const Parameter& parameter : parameters_of(run.simulation.parameters.lasers))
        all.emplace_back(parameter.name, parameter.get(console, run));
    return all;
}

/// What the journal keeps: the changes, and the scenario to which they were made.
std::string written(const std::vector<std::string>& changes, const std::string& scenario) {
    std::string text = "adopt";
    for (std::string change : changes) {
        std::replace(change.begin(), change.end(), '\n', ' ');
        text += fmt::format(" {}", as_word(change));
    }
    return fmt::format("{} under {}", text, fingerprint(scenario));
}

} // namespace

std::string adoption(const std::vector<std::string>& changes, const std::filesystem::path& other_scenario,
                     const std::string& scenario) {
    if (!other_scenario.empty())
        return written({"scenario", other_scenario.string()}, scenario);
    const auto file = std::find_if(changes.begin(), changes.end(), names_a_file);
    return written(file == changes.end() ? changes : std::vector<std::string>{"scenario", *file}, scenario);
}

void adopt_picture_settings(ConsoleState& console, const std::vector<std::string>& words) {
    const RenderSettings& given = console.host.render;
    RenderSettings settings = console.render;
    for (const std::string& word : words) {
        const auto is = [&](const char* key) { return word.starts_with(key); };
        if (is("render.views"))
            settings.views = given.views;
        else if (is("render.color_range"))
            settings.color_range = given.color_range;
        else if (is("render.colormap"))
            settings.colormap = given.colormap;
        else if (is("render.background"))
            settings.background = given.background;
    }
    if (settings == console.render)
        return;
    if (console.host.set_render)
        console.host.set_render(settings);
    console.render = settings;
}

std::string do_adopt(Call& call) {
    ConsoleState& console = call.console;
    Run& run = call.run;
    std::vector<std::string> changes;
    std::string elsewhere, before;
    while (!call.arguments.empty()) {
        if (call.arguments.take("under"))
            before = call.arguments.word("the scenario's fingerprint");
        else if (call.arguments.take("scenario"))
            elsewhere = call.arguments.word("the scenario");
        else
            changes.push_back(call.arguments.word("KEY=VALUE"));
    }
    if (!before.empty() && before != fingerprint(console.host.scenario))
        throw CommandError(
            "the journal goes on from another scenario than this; it has to be replayed with the "
            "one that its run began with");
    if (!elsewhere.empty())
        throw CommandError(fmt::format("the run was taken up here under {}, which the journal does not hold; "
                                       "take that checkpoint up again, with --replay",
                                       elsewhere));
    if (changes.empty())
        throw CommandError("KEY=VALUE is missing, for example level_set.epsilon=0.6");
    const auto file = std::find_if(changes.begin(), changes.end(), names_a_file);
    if (file != changes.end())
        throw CommandError(fmt::format("\"{}\" reads another file, which a journal does not hold", *file));
    if (!console.host.adopt)
        throw CommandError("this run has no scenario that could be changed");
    const std::string scenario = console.host.scenario;
    const auto shown_before = shown_values(console, run);
    console.host.adopt(run, console.host, changes);
    adopt_picture_settings(console, changes);
    call.journal = written(changes, scenario);
    std::string text;
    const auto shown_now = shown_values(console, run);
    for (std::size_t n = 0; n < std::min(shown_now.size(), shown_before.size()); ++n)
        if (shown_now[n] != shown_before[n])
            text += fmt::format("{}: {} -> {}\n", shown_now[n].first, shown_before[n].second,
                                shown_now[n].second);
    return fmt::format("{}adopted (step {}, t = {})", text, run.simulation.step,
                       shown(run.simulation.time, "s"));
}

} // namespace meltscope
