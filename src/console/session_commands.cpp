#include "meltscope/console/commands.hpp"
#include "meltscope/console/parameters.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

/// Commands about commands.
namespace meltscope {

std::string do_record(Call& call) {
    std::filesystem::path& recording = call.console.recording;
    if (call.arguments.empty())
        return recording.empty() ? "nothing is recorded; record FILE begins"
                                 : "recording into " + recording.string();
    if (call.arguments.peek() == "stop") {
        call.arguments.word("stop");
        call.arguments.done();
        const std::string text =
            recording.empty() ? "nothing was recorded" : "recorded into " + recording.string();
        recording.clear();
        return text;
    }
    const std::filesystem::path file = file_to_write(call);
    call.arguments.done();
    if (std::filesystem::exists(file))
        throw CommandError(fmt::format("{} is there already", file.string()));
    if (!(std::ofstream(file) << "# Commands for `source FILE` or --script FILE\n"))
        throw CommandError(fmt::format("{} cannot be written", file.string()));
    recording = file;
    return fmt::format("recording into {}; `record stop` ends it", file.string());
}

std::string do_history(Call& call) {
    call.arguments.done();
    constexpr std::size_t most = 50;
    const std::vector<std::string>& lines = call.console.lines;
    std::string text;
    for (std::size_t n = lines.size() > most ? lines.size() - most : 0; n < lines.size(); ++n)
        text += fmt::format("{}{:>4}  {}", text.empty() ? "" : "\n", n + 1, lines[n]);
    return text.empty() ? "no command yet" : text;
}

std::string do_source(Call& call) {
    const std::string file = call.arguments.word("the file");
    call.arguments.done();
    if (call.console.from_journal)
        throw CommandError("a journal reads no other file");
    std::error_code ignored;
    std::ifstream stream(file);
    if (!std::filesystem::is_regular_file(file, ignored) || !stream) // a device or a pipe may never end
        throw CommandError(fmt::format("{} cannot be read", file));
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    call.console.sourced = std::move(lines);
    call.console.sourced_from = file;
    return {};
}

std::string do_help(Call& call) {
    if (call.arguments.empty())
        return help_text();
    const std::string name = call.arguments.word("the command");
    call.arguments.done();
    if (name.find('.') == std::string::npos)
        return help_text(find_command(name));
    const Parameter parameter = find_parameter(call.run.simulation.parameters.lasers, name);
    return fmt::format("{} = {}\n  {}\n  values: {}", parameter.name, parameter.get(call.console, call.run),
                       parameter.help, parameter.values);
}

std::string do_detach(Call& call) {
    call.arguments.done();
    throw CommandError("this console is the run's own; `quit` ends both");
}

} // namespace meltscope
