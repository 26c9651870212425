#include "meltscope/console/console_state.hpp"

#include "meltscope/console/commands.hpp"
#include "meltscope/console/parameters.hpp"
#include "meltscope/io/atomic_file.hpp"
#include "meltscope/io/run_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <utility>

namespace meltscope {
namespace {

constexpr const char* journal_header =
    "# What changed the run. `meltscope run SCENARIO --replay journal.txt` does it again.\n";

/// Puts what is new of the journal into journal.txt.
void write_journal(ConsoleState& console, const Run& run) {
    if (console.host.folder.empty())
        return;
    const auto path = RunPaths{console.host.folder}.journal();
    std::ofstream file(path, std::ios::app | std::ios::binary);
    file << run.journal.substr(console.journal_written) << std::flush;
    if (!file)
        throw CommandError(
            fmt::format("{} cannot be written; the run itself went on as told", path.string()));
    console.journal_written = run.journal.size();
}

void note(ConsoleState& console, Run& run, const std::string& command, bool waited) {
    run.journal += journal_line({run.simulation.step, run.simulation.time, command, waited, 0});
    write_journal(console, run);
}

std::string text_of(const std::vector<JournalEntry>& entries) {
    std::string text;
    for (const JournalEntry& entry : entries)
        text += journal_line(entry);
    return text;
}

/// A run that goes on has not been stopped: a last `quit` is taken back. One that waited for its time leaves
/// the landing that it caused.
void take_back_stop(std::vector<JournalEntry>& entries) {
    if (entries.empty() || entries.back().command != "quit")
        return;
    const JournalEntry last = entries.back();
    entries.pop_back();
    if (!last.waited)
        return;
    for (JournalEntry& entry : entries)
        if (!entry.waited && entry.command.starts_with("at ") && entry.command.ends_with(" quit"))
            entry.command =
                "land " + entry.command.substr(3, entry.command.size() - 3 - std::string(" quit").size());
}

/// Carries out a line that is known to be one of the journal's, without noting it again.
void take_up(ConsoleState& console, Run& run, const JournalEntry& entry) {
    if (entry.waited) {
        const auto done =
            std::find_if(console.waiting.begin(), console.waiting.end(), [&](const WaitingCommand& w) {
                return w.command == entry.command &&
                       (w.time <= entry.time || same_instant(w.time, entry.time));
            });
        if (done != console.waiting.end())
            console.waiting.erase(done);
        return;
    }
    const double now = std::exchange(run.simulation.time, entry.time); // times are judged as they were then
    try {
        const std::vector<std::string> words = split_words(entry.command);
        const bool picture_setting = words.size() > 2 && words[0] == "set" &&
                                     words[1].starts_with("render.") && words[1] != "render.every";
        console.from_journal = true;
        if (!words.empty() && words[0] == "adopt")
            adopt_picture_settings(console, words);
        if (!words.empty() && (words[0] == "at" || words[0] == "land" || picture_setting)) {
            Arguments arguments({words.begin() + 1, words.end()});
            Call call{console, run, arguments, {}, false};
            find_command(words[0]).handler(call);
        }
    } catch (const std::exception& error) {
        console.from_journal = false;
        run.simulation.time = now;
        throw JournalError(fmt::format("the journal of the run: \"{}\": {}", entry.command, error.what()));
    }
    console.from_journal = false;
    run.simulation.time = now;
}

Reply carry_out(ConsoleState& console, Run& run, std::string_view line, bool waited) {
    Reply reply;
    try {
        std::vector<std::string> words = split_words(line);
        if (words.empty())
            return reply;
        const Command& command = find_command(words[0]);
        Arguments arguments({words.begin() + 1, words.end()});
        Call call{console, run, arguments, {}, false};
        reply.text = command.handler(call);
        reply.starts = call.starts;
        if (!call.journal.empty() && !waited)
            note(console, run, call.journal, false);
    } catch (const std::exception& error) {
        reply.ok = false;
        reply.text = error.what();
    }
    return reply;
}

} // namespace

bool at_end_of_run(const Run& run) {
    const double end = std::min(run.simulation.parameters.time.end, run.until.value_or(never));
    return run.simulation.time >= end || (run.last_step && run.simulation.step >= *run.last_step);
}

Reply execute(ConsoleState& console, Run& run, std::string_view line) {
    const Reply reply = carry_out(console, run, line, false);
    if (line.find_first_not_of(" \t\r") == std::string_view::npos)
        return reply;
    console.lines.emplace_back(line);
    if (reply.ok && !console.recording.empty() && !line.starts_with("rec"))
        std::ofstream(console.recording, std::ios::app) << line << '\n';
    return reply;
}

void take_up_journal(ConsoleState& console, Run& run) {
    std::vector<JournalEntry> entries = parse_journal(run.journal, "journal of the run");
    take_back_stop(entries);
    run.journal = text_of(entries);
    console.waiting.clear();
    console.landings.clear();
    for (const JournalEntry& entry : entries)
        take_up(console, run, entry);
    if (console.host.folder.empty())
        return;
    write_file_atomically(RunPaths{console.host.folder}.journal(), journal_header + run.journal);
    console.journal_written = run.journal.size();
}

void note_adoption(ConsoleState& console, Run& run) {
    if (console.host.adopted.empty())
        return;
    note(console, run, console.host.adopted, false);
    adopt_picture_settings(console, split_words(console.host.adopted));
}

std::vector<Reply> execute_due(ConsoleState& console, Run& run) {
    std::vector<Reply> replies;
    const auto is_due = [&](double time) {
        return time <= run.simulation.time || same_instant(time, run.simulation.time);
    };
    while (!console.waiting.empty() && is_due(console.waiting.front().time) && !run.stop_reason) {
        const WaitingCommand due = console.waiting.front();
        console.waiting.erase(console.waiting.begin());
        Reply reply;
        try {
            note(console, run, without_file_to_write(due.command), true);
            reply = carry_out(console, run, due.command, true);
        } catch (const std::exception& error) {
            reply = {false, error.what(), false};
        }
        reply.text = fmt::format("at {}: {}{}{}", shown(due.time, "s"), due.command,
                                 reply.text.empty() ? "" : ": ", reply.text);
        if (!reply.ok && due.must_succeed)
            stop(console, run, reply.text);
        replies.push_back(std::move(reply));
    }
    return replies;
}

double next_landing(const ConsoleState& console, double time) {
    double next = never;
    for (const double landing : console.landings)
        if (landing > time)
            next = std::min(next, landing);
    for (const WaitingCommand& waiting : console.waiting)
        if (waiting.time > time)
            next = std::min(next, waiting.time);
    return next;
}

void note_landing(ConsoleState& console, Run& run) {
    const double time = run.simulation.time;
    if (!run.until || *run.until <= time || *run.until >= run.simulation.parameters.time.end)
        return;
    const OutputSchedule& schedule = run.schedule;
    const double scheduled =
        std::min({next_due(schedule.output, time), next_due(schedule.picture.value_or(schedule.output), time),
                  next_due(schedule.checkpoint, time), next_landing(console, time)});
    if (*run.until >= scheduled || same_instant(*run.until, scheduled))
        return; // the loop lands on the scheduled instant
    console.landings.push_back(*run.until);
    note(console, run, fmt::format("land {} s", exact(*run.until)), false);
}

void stop(ConsoleState& console, Run& run, const std::string& reason) {
    if (run.stop_reason)
        return;
    if (at_end_of_run(run)) {
        console.leaves = true;
        return;
    }
    run.stop_reason = reason;
    try {
        note(console, run, "quit", false);
    } catch (const CommandError&) {
        // journal.txt cannot be written; the checkpoint still gets the journal
    }
}

} // namespace meltscope
