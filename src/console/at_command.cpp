#include "meltscope/console/commands.hpp"
#include "meltscope/io/steering.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

/// The command `at`: others that wait for their time.
namespace meltscope {
namespace {

/// Commands that must not wait: a later one would depend on files that may have changed, or never end.
bool may_wait(const std::string& name) {
    for (const char* no : {"at", "source", "restore", "record", "land", "adopt", "detach"})
        if (name == no)
            return false;
    return true;
}

/// Has a command judge its words as it will at that time, and puts back what it has changed. Returns what
/// would forbid it as things stand; throws what will be wrong in any case.
std::string rehearse(Call& call, const Command& command, const std::string& words, double time) {
    ConsoleState& console = call.console;
    Run& run = call.run;
    const Steering steering = steering_of(run.simulation.parameters, run.schedule);
    const RenderSettings render = console.render;
    const double now = std::exchange(run.simulation.time, time);
    const auto put_back = [&] {
        apply_steering(steering, run.simulation.parameters, run.schedule);
        console.render = render;
        run.simulation.time = now;
    };
    std::string obstacle;
    try {
        Arguments arguments(split_words(words));
        Call trial{console, run, arguments, {}, false, true};
        command.handler(trial);
    } catch (const NotNow& error) {
        obstacle = error.what();
    } catch (...) {
        put_back();
        throw;
    }
    put_back();
    return obstacle;
}

bool writes_file(const std::string& name) {
    return name == "save" || name == "snapshot";
}

} // namespace

std::string without_file_to_write(const std::string& line) {
    const std::vector<std::string> words = split_words(line);
    return !words.empty() && writes_file(words[0]) ? words[0] : line;
}

std::string do_at(Call& call) {
    Arguments& arguments = call.arguments;
    Run& run = call.run;
    std::vector<std::string> names;
    for (const Command& command : command_table())
        names.push_back(command.name);
    const double time = arguments.quantity("the time", quantity::time, names);
    require_between(time, 0.0, never, "the time", "s");
    const Command& command = find_command(arguments.word("the command"));
    if (!may_wait(command.name))
        throw CommandError(fmt::format("`{}` cannot wait for a time", command.name));
    const std::string rest = arguments.rest();
    std::string line = command.name + (rest.empty() ? "" : " " + rest);
    if (call.console.from_journal && line != without_file_to_write(line))
        throw CommandError("a journal names no file to write");
    if (command.name == "path")
        line = with_path_file_inlined(line);
    if (time < run.simulation.time && !same_instant(time, run.simulation.time))
        throw CommandError(
            fmt::format("{} has passed, it is {}", shown(time, "s"), shown(run.simulation.time, "s")));
    std::string obstacle; // a journal's commands were judged when they were given
    if (!call.console.from_journal)
        obstacle = rehearse(call, command, line.substr(command.name.size()), time);
    std::vector<WaitingCommand>& waiting = call.console.waiting;
    const auto place = std::upper_bound(waiting.begin(), waiting.end(), time,
                                        [](double t, const WaitingCommand& w) { return t < w.time; });
    waiting.insert(place, {time, line, call.console.must_succeed});
    call.journal = fmt::format("at {} s {}", exact(time), without_file_to_write(line));
    const bool never_comes = time > run.simulation.parameters.time.end;
    return fmt::format("waits for {}: {}{}{}", shown(time, "s"), line,
                       never_comes ? " (the run ends before)" : "",
                       obstacle.empty() ? "" : fmt::format("\nas things stand it will fail: {}", obstacle));
}

} // namespace meltscope
