#include "meltscope/console/console.hpp"

#include "meltscope/console/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace meltscope {
namespace {

/// How often a waiting console looks whether the program wants to stop.
constexpr std::chrono::milliseconds look_interval{50};

} // namespace

Console::Console(ConsoleHost host, bool paused) : state_(std::move(host)) {
    state_.running = !paused;
}

void Console::replay(const std::string& journal, const std::string& name) {
    replay_ = parse_journal(journal, name);
    std::erase_if(replay_, [](const JournalEntry& entry) { return entry.waited; });
    replay_name_ = name;
}

Console::Id Console::open(Speaker speaker) {
    const std::lock_guard lock(mutex_);
    auto voice = std::make_unique<Voice>();
    voice->id = next_id_++;
    voice->speaker = std::move(speaker);
    voices_.push_back(std::move(voice));
    return voices_.back()->id;
}

bool Console::say(Id speaker, std::string line) {
    const std::lock_guard lock(mutex_);
    for (const auto& voice : voices_) {
        if (voice->id != speaker)
            continue;
        if (voice->lines.size() >= voice->speaker.most_lines)
            return false;
        ++voice->count;
        const std::string& name = voice->speaker.name;
        voice->lines.push_back(
            {std::move(line), name.empty() ? name : fmt::format("{}:{}", name, voice->count), true});
        interrupts_ = 0;
        something_new_.notify_all();
        return true;
    }
    return false;
}

void Console::finish(Id speaker) {
    const std::lock_guard lock(mutex_);
    for (const auto& voice : voices_)
        if (voice->id == speaker)
            voice->finished = true;
    something_new_.notify_all();
}

void Console::close(Id speaker) {
    const std::lock_guard lock(mutex_);
    std::erase_if(voices_, [&](const auto& voice) { return voice->id == speaker; });
    something_new_.notify_all();
}

void Console::interrupt() {
    const std::lock_guard lock(mutex_);
    ++interrupts_;
    interrupt_new_ = true;
    something_new_.notify_all();
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
    const std::lock_guard lock(mutex_);
    for (const Parameter& parameter : parameters_of(run.simulation.parameters.lasers))
        names_.parameters.push_back(parameter.name);
    names_.fields = state_.host.fields;
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
    int count = 0;
    {
        const std::lock_guard lock(mutex_);
        if (!interrupt_new_)
            return false;
        interrupt_new_ = false;
        count = interrupts_;
    }
    if (count >= 2) {
        stop(state_, run, "interrupted twice");
    } else {
        state_.running = false;
        tell_all(fmt::format("paused at step {}, t = {}; Ctrl-C again stops with a checkpoint",
                             run.simulation.step, shown(run.simulation.time, "s")));
    }
    return true;
}

void Console::tell(Id id, const std::string& line, const Reply& reply) {
    std::function<void(const std::string&, const Reply&)> answer;
    {
        const std::lock_guard lock(mutex_);
        for (const auto& voice : voices_)
            if (voice->id == id)
                answer = voice->speaker.answer;
    }
    if (answer)
        answer(line, reply);
}

void Console::tell_others(Id id, const std::string& text) {
    std::vector<std::function<void(const std::string&, const Reply&)>> answers;
    {
        const std::lock_guard lock(mutex_);
        for (const auto& voice : voices_)
            if (voice->id != id && voice->speaker.answer)
                answers.push_back(voice->speaker.answer);
    }
    for (const auto& answer : answers)
        answer({}, {true, text, false});
}

void Console::tell_all(const std::string& text) {
    tell_others(0, text);
}

std::deque<Console::Line>::iterator Console::Voice::next_line(std::int64_t goals_reached) {
    if (lines.empty() || waits_for <= goals_reached)
        return lines.begin();
    // Scripts wait; so does the rest of a sourced file, but not what is typed meanwhile.
    return speaker.waits
               ? lines.end()
               : std::find_if(lines.begin(), lines.end(), [](const Line& line) { return line.given; });
}

bool Console::do_next_line(Run& run) {
    Line line;
    Id id = 0;
    {
        const std::lock_guard lock(mutex_);
        for (const auto& voice : voices_) {
            const auto next = voice->next_line(goals_reached_);
            if (next == voice->lines.end())
                continue;
            line = std::move(*next);
            voice->lines.erase(next);
            id = voice->id;
            break;
        }
    }
    if (id == 0)
        return false;
    carry_out(run, id, line);
    return true;
}

void Console::carry_out(Run& run, Id id, const Line& line) {
    Speaker speaker;
    {
        const std::lock_guard lock(mutex_);
        const auto voice =
            std::find_if(voices_.begin(), voices_.end(), [&](const auto& v) { return v->id == id; });
        if (voice == voices_.end())
            return;
        speaker = (*voice)->speaker;
    }
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
    const bool names_place = !reply.ok && !line.place.empty();
    if (names_place)
        reply.text = fmt::format("{}: {}: {}", line.place, line.text, reply.text);
    {
        const std::lock_guard lock(mutex_);
        for (const auto& voice : voices_) {
            if (voice->id != id)
                continue;
            if (reply.starts && (speaker.waits || !line.given))
                voice->waits_for = state_.goal.number;
            if (!reply.ok) // what is left of a sourced file
                while (!voice->lines.empty() && !voice->lines.front().given)
                    voice->lines.pop_front();
            if (voice->lines.size() + state_.sourced.size() > speaker.most_lines) {
                reply = {false, "too many lines wait: does a file read itself?", false};
                while (!voice->lines.empty() && !voice->lines.front().given)
                    voice->lines.pop_front();
            } else {
                for (std::size_t n = state_.sourced.size(); n-- > 0;)
                    voice->lines.push_front(
                        {state_.sourced[n], fmt::format("{}:{}", state_.sourced_from, n + 1), false});
            }
            state_.sourced.clear();
        }
    }
    tell(id, line.text, reply);
    if (reply.ok && !looks) // all may know what is done to the run
        tell_others(id, fmt::format("({}) {}", line.text, reply.text));
    if (!reply.ok && speaker.must_succeed) {
        script_error_ = reply.text;
        stop(state_, run, reply.text);
    }
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
    bool stops = false, goes_on = false, prompt = false;
    {
        const std::lock_guard lock(mutex_);
        std::erase_if(voices_, [&](const auto& voice) {
            const bool silent = voice->finished && voice->lines.empty() && voice->waits_for <= goals_reached_;
            stops = stops || (silent && voice->speaker.stops_at_end);
            goes_on = goes_on || (silent && voice->speaker.waits);
            prompt = prompt || (!silent && voice->speaker.keeps_run);
            return silent;
        });
    }
    if (prompt)
        return;
    if (stops)
        stop(state_, run, "end of input");
    else if (goes_on)
        state_.running = true;
}

/// True if a run that does not go on has nobody to tell it what to do.
bool Console::waits_for_nobody(const Run& run) const {
    const std::lock_guard lock(mutex_);
    if (!at_end_of_run(run)) // a replay repeats no pauses; else a console may be attached
        return voices_.empty() && !replay_.empty();
    return std::none_of(voices_.begin(), voices_.end(),
                        [](const auto& voice) { return voice->speaker.keeps_run || voice->speaker.waits; });
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
        std::unique_lock lock(mutex_);
        const auto is_new = [this] {
            return interrupt_new_ || std::any_of(voices_.begin(), voices_.end(), [this](const auto& voice) {
                       return voice->next_line(goals_reached_) != voice->lines.end();
                   });
        };
        something_new_.wait_for(lock, look_interval, is_new);
    }
}

} // namespace meltscope
