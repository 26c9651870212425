#include "meltscope/console/console.hpp"

#include "meltscope/console/parameters.hpp"

#include "voices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace meltscope {
namespace {

/// How often a waiting console looks whether the program wants to stop.
constexpr std::chrono::milliseconds look_interval{50};

} // namespace

Console::Console(ConsoleHost host, bool paused)
    : state_(std::move(host)), voices_(std::make_unique<Voices>()) {
    state_.running = !paused;
}

Console::~Console() = default;

void Console::replay(const std::string& journal, const std::string& name) {
    replay_ = parse_journal(journal, name);
    std::erase_if(replay_, [](const JournalEntry& entry) { return entry.waited; });
    replay_name_ = name;
}

Console::Id Console::open(Speaker speaker) {
    return voices_->open(std::move(speaker));
}

bool Console::say(Id speaker, std::string line) {
    return voices_->say(speaker, std::move(line));
}

void Console::finish(Id speaker) {
    voices_->finish(speaker);
}

void Console::close(Id speaker) {
    voices_->close(speaker);
}

void Console::interrupt() {
    voices_->interrupt();
}

std::string Console::status_line() const {
    const std::lock_guard lock(mutex_);
    return status_;
}

CompletionNames Console::completion_names() const {
    const std::lock_guard lock(mutex_);
    return names_;
}

CommandSource Console::source() {
    return {[this](Run& run) { apply(run); },
            [this](const Run& run) { return next_landing(state_, run.simulation.time); }};
}

std::string Console::left_of_replay() const {
    return replayed_ == replay_.size() ? std::string()
                                       : fmt::format("{}:{}: the run ended before step {}", replay_name_,
                                                     replay_[replayed_].line, replay_[replayed_].step);
}

void Console::begin(Run& run) {
    begun_ = true;
    take_up_journal(state_, run);
    note_adoption(state_, run);
    // A run taken up from a checkpoint has done the first part of the journal that it replays.
    const std::vector<JournalEntry> done = parse_journal(run.journal, "journal of the run");
    for (const JournalEntry& entry : done) {
        if (entry.waited || replay_.empty())
            continue;
        if (replayed_ == replay_.size() || !(replay_[replayed_] == entry))
            throw JournalError(
                fmt::format("{} is not the journal that led to step {}", replay_name_, run.simulation.step));
        ++replayed_;
    }
    publish_names(run);
}

void Console::publish_names(const Run& run) {
    CompletionNames names;
    const std::vector<Laser>& lasers = run.simulation.parameters.lasers;
    for (const Parameter& parameter : parameters_of(lasers))
        names.parameters.push_back(parameter.name);
    for (const Laser& laser : lasers)
        names.lasers.push_back(laser.name);
    for (const Material& material : run.simulation.parameters.materials)
        names.materials.push_back(material.name);
    names.fields = state_.host.fields;
    const std::lock_guard lock(mutex_);
    names_ = std::move(names);
}

void Console::replay_due(Run& run) {
    const Simulation& simulation = run.simulation;
    while (replayed_ < replay_.size() && !run.stop_reason) {
        const JournalEntry& entry = replay_[replayed_];
        if (entry.step > simulation.step)
            return;
        const std::string place = fmt::format("{}:{}", replay_name_, entry.line);
        if (entry.step < simulation.step || entry.time != simulation.time)
            throw JournalError(
                fmt::format("{}: the run departs from the journal: step {} ended at t = {} s, not at {} s",
                            place, simulation.step, exact(simulation.time), exact(entry.time)));
        ++replayed_;
        state_.from_journal = true;
        const Reply reply = execute(state_, run, entry.command);
        state_.from_journal = false;
        if (!reply.ok)
            throw JournalError(fmt::format("{}: {}: {}", place, entry.command, reply.text));
        tell_all(fmt::format("{}: {}{}{}", place, entry.command, reply.text.empty() ? "" : ": ", reply.text));
    }
}

bool Console::interrupted(Run& run) {
    const std::optional<int> count = voices_->take_interrupts();
    if (!count)
        return false;
    if (*count >= 2) {
        stop(state_, run, "interrupted twice");
    } else {
        state_.running = false;
        tell_all(fmt::format("paused at step {}, t = {}; Ctrl-C again stops with a checkpoint",
                             run.simulation.step, shown(run.simulation.time, "s")));
    }
    return true;
}

void Console::tell_all(const std::string& text) {
    voices_->tell_others(0, text);
}

bool Console::do_next_line(Run& run) {
    const auto next = voices_->take_next(goals_reached_);
    if (!next)
        return false;
    const auto& [id, speaker, line] = *next;
    const std::int64_t goal_before = state_.goal.number;
    Reply reply;
    bool looks = true;
    try {
        const std::vector<std::string> words = split_words(line.text);
        looks = words.empty() || find_command(words[0]).effect == Effect::looks;
        if (!speaker.may_change && !looks)
            throw CommandError("another console has the say; here only commands that look are carried out");
        state_.must_succeed = speaker.must_succeed;
        reply = execute(state_, run, line.text);
    } catch (const CommandError& error) {
        reply = {false, error.what(), false};
    }
    if (state_.goal.number != goal_before) // a new goal takes the place of the old one
        goals_reached_ = std::max(goals_reached_, goal_before);
    if (!reply.ok && !line.place.empty())
        reply.text = fmt::format("{}: {}: {}", line.place, line.text, reply.text);
    if (reply.starts && (speaker.waits || !line.given))
        voices_->let_wait(id, state_.goal.number);
    if (!reply.ok)
        voices_->drop_sourced(id);
    const std::vector<std::string> sourced = std::exchange(state_.sourced, {});
    if (!voices_->put_first(id, sourced, state_.sourced_from))
        reply = {false, "too many lines wait: does a file read itself?", false};
    voices_->tell(id, line.text, reply);
    if (reply.ok && !looks) // all may know what is done to the run
        voices_->tell_others(id, fmt::format("({}) {}", line.text, reply.text));
    if (!reply.ok && speaker.must_succeed) {
        script_error_ = reply.text;
        stop(state_, run, reply.text);
    }
    return true;
}

void Console::reach_goal(Run& run) {
    Goal& goal = state_.goal;
    const double time = run.simulation.time;
    const bool there = (goal.step && run.simulation.step >= *goal.step) ||
                       (goal.time && (time >= *goal.time || same_instant(time, *goal.time)));
    const bool ended = at_end_of_run(run);
    const bool is_news = ended ? !said_end_ : there && goals_reached_ < goal.number;
    said_end_ = ended;
    if (!is_news)
        return;
    goals_reached_ = goal.number;
    goal = {goal.number, std::nullopt, std::nullopt};
    state_.running = false;
    tell_all(fmt::format("{} step {}, t = {}", ended ? "the run has reached its end at" : "paused at",
                         run.simulation.step, shown(time, "s")));
}

/// Lets go of those who have said all. After a script the run goes on, after a pipe it stops, unless a prompt
/// is open.
void Console::retire_silent_voices(Run& run) {
    const Voices::Retired retired = voices_->retire_silent(goals_reached_);
    if (retired.prompt)
        return;
    if (retired.stops)
        stop(state_, run, "end of input");
    else if (retired.goes_on)
        state_.running = true;
}

/// True if a run that does not go on has nobody to tell it what to do.
bool Console::waits_for_nobody(const Run& run) const {
    if (!at_end_of_run(run)) // a replay repeats no pauses; else a console may be attached
        return voices_->none() && !replay_.empty();
    return !voices_->any_keeps_run();
}

void Console::publish(const Run& run) {
    const Simulation& s = run.simulation;
    const std::string text =
        fmt::format("{} {:.0f}% step {} t {}", state_.running && !at_end_of_run(run) ? "running" : "paused",
                    100.0 * s.time / s.parameters.time.end, s.step, shown(s.time, "s"));
    const std::lock_guard lock(mutex_);
    status_ = text;
}

void Console::apply(Run& run) {
    if (!begun_)
        begin(run);
    for (;;) {
        for (const Reply& reply : execute_due(state_, run)) {
            tell_all(reply.ok ? reply.text : "error: " + reply.text);
            if (!reply.ok && run.stop_reason)
                script_error_ = reply.text;
        }
        if (run.stop_reason || state_.leaves)
            return;
        replay_due(run);
        reach_goal(run);
        publish(run);
        if (!run.stop_reason && (interrupted(run) || do_next_line(run)))
            continue;
        retire_silent_voices(run);
        if (run.stop_reason || state_.leaves)
            return;
        if (state_.running || waits_for_nobody(run)) {
            state_.running = true;
            note_landing(state_, run);
            return;
        }
        if (state_.host.stop_request)
            if (const auto reason = state_.host.stop_request()) {
                run.stop_reason = *reason;
                return;
            }
        voices_->wait_for_next(goals_reached_, look_interval);
    }
}

} // namespace meltscope
