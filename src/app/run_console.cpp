#include "run_console.hpp"

#include "exit_codes.hpp"

#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/scenario/setup.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <sstream>

namespace meltscope {
namespace {

std::string contents_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream || std::filesystem::is_directory(file))
        throw UsageError(fmt::format("{} cannot be read", file.string()));
    return {std::istreambuf_iterator<char>(stream), {}};
}

RenderSettings render_settings(const RenderSpec& spec) {
    RenderSettings settings;
    settings.views = spec.views;
    settings.color_range = spec.color_range;
    settings.colormap = spec.colormap;
    settings.background = spec.background == RenderSpec::Background::light ? "light" : "dark";
    return settings;
}

void take_scenario(ConsoleHost& host, const Scenario& scenario) {
    host.scenario = to_toml(scenario);
    host.parameters = run_parameters(scenario);
    if (!scenario.layers.empty())
        host.layer = scenario.layers.front().layer;
    host.render = render_settings(scenario.render);
}

ConsoleHost host_of(const RunPaths& paths, PreparedRun& prepared, RunOutputs& outputs,
                    std::function<std::optional<std::string>()> stop_request) {
    ConsoleHost host;
    host.folder = paths.root;
    take_scenario(host, prepared.scenario);
    host.adopted = prepared.adopted;
    host.adopt = [&prepared, &outputs](Run&, ConsoleHost& console, const std::vector<std::string>& changes) {
        adopt_changes(prepared, changes);
        take_scenario(console, prepared.scenario);
        outputs.scenario_changed();
    };
    host.fields = viz::field_names();
    host.set_render = [&outputs](const RenderSettings& settings) { outputs.set_render(settings); };
    if (outputs.draws())
        host.write_picture = [&outputs](const Run& run, const std::string& view,
                                        const std::filesystem::path& png) {
            outputs.write_picture(run, view, png);
        };
    host.restored = [&outputs](const Run& run) { outputs.restored(run); };
    host.stop_request = std::move(stop_request);
    return host;
}

bool says_something(const std::string& line) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    return first != std::string::npos && line[first] != '#';
}

} // namespace

RunConsole::RunConsole(const SteeringRequest& request, const RunPaths& paths, PreparedRun& prepared,
                       RunOutputs& outputs, Terminal& terminal,
                       std::function<std::optional<std::string>()> stop_request)
    : terminal_(terminal), console_(host_of(paths, prepared, outputs, std::move(stop_request)),
                                    (request.prompt || !request.script.empty()) && request.replay.empty()) {
    if (!request.replay.empty())
        replay(request.replay);
    if (!request.script.empty())
        say_script(request.script);
    open_attach(paths);
    if (request.prompt)
        open_prompt();
}

RunConsole::~RunConsole() {
    close();
}

void RunConsole::close() {
    if (editor_)
        terminal_.speak_through({});
    editor_.reset();
    server_.reset();
}

void RunConsole::finish() {
    close();
    if (const std::string left = console_.left_of_replay(); !left.empty())
        terminal_.warn(left);
}

void RunConsole::replay(const std::filesystem::path& journal) {
    try {
        console_.replay(contents_of(journal), journal.string());
    } catch (const JournalError& error) {
        throw UsageError(error.what());
    }
}

void RunConsole::say_script(const std::filesystem::path& script) {
    std::istringstream lines(contents_of(script));
    Speaker speaker;
    speaker.name = script.string();
    speaker.waits = speaker.must_succeed = true;
    speaker.answer = [this](const std::string& line, const Reply& reply) {
        if (says_something(line))
            terminal_.say("> " + line);
        if (reply.ok && !reply.text.empty()) // an error is told when the run has stopped
            terminal_.say(reply.text);
    };
    const Console::Id id = console_.open(std::move(speaker));
    for (std::string line; std::getline(lines, line);)
        console_.say(id, line);
    console_.finish(id);
}

void RunConsole::open_prompt() {
    const bool person = isatty(STDIN_FILENO) == 1;
    Speaker speaker;
    speaker.name = person ? "" : "<standard input>";
    speaker.waits = speaker.must_succeed = speaker.stops_at_end = !person;
    speaker.keeps_run = person;
    if (person)
        speaker.answer = [this](const std::string&, const Reply& reply) {
            if (!reply.text.empty())
                terminal_.say(reply.ok ? reply.text : "error: " + reply.text);
        };
    else
        speaker.answer = [this](const std::string& line, const Reply& reply) {
            if (says_something(line))
                terminal_.say("> " + line);
            if (reply.ok && !reply.text.empty())
                terminal_.say(reply.text);
        };
    const Console::Id id = console_.open(std::move(speaker));
    LineEditor::Callbacks callbacks;
    callbacks.line = [this, id, person](const std::string& line) {
        const bool taken = console_.say(id, line);
        if (!taken && person)
            terminal_.warn("too many lines wait; this one is dropped: " + line);
        return taken;
    };
    callbacks.interrupt = [this] { console_.interrupt(); };
    callbacks.end = [this, id, person] {
        if (person)
            console_.say(id, "quit");
        console_.finish(id);
    };
    callbacks.complete = [this](std::string_view line) {
        return completions(line, console_.completion_names());
    };
    callbacks.status = [this] { return console_.status_line(); };
    if (person)
        terminal_.say("`help` lists the commands, `run` lets the run go, `quit` ends it.");
    editor_ = std::make_unique<LineEditor>("meltscope> ", history_file(), std::move(callbacks));
    if (person)
        terminal_.speak_through([editor = editor_.get()](const std::string& text) { editor->print(text); });
}

void RunConsole::open_attach(const RunPaths& paths) {
    try {
        server_ = std::make_unique<AttachServer>(paths.root, console_);
    } catch (const AttachError& error) {
        terminal_.note(fmt::format("no console can be attached: {}", error.what()));
    }
}

} // namespace meltscope
