#include "voices.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace meltscope {

std::deque<SpokenLine>::iterator Voices::Voice::next_line(std::int64_t goals_reached) {
    if (lines.empty() || waits_for <= goals_reached)
        return lines.begin();
    // Scripts wait; so does the rest of a sourced file, but not what is typed meanwhile.
    return speaker.waits
               ? lines.end()
               : std::find_if(lines.begin(), lines.end(), [](const SpokenLine& line) { return line.given; });
}

void Voices::Voice::drop_sourced() {
    while (!lines.empty() && !lines.front().given)
        lines.pop_front();
}

Voices::Voice* Voices::find(Id id) {
    const auto found =
        std::find_if(voices_.begin(), voices_.end(), [&](const auto& voice) { return voice->id == id; });
    return found == voices_.end() ? nullptr : found->get();
}

Voices::Id Voices::open(Speaker speaker) {
    const std::lock_guard lock(mutex_);
    auto voice = std::make_unique<Voice>();
    voice->id = next_id_++;
    voice->speaker = std::move(speaker);
    voices_.push_back(std::move(voice));
    return voices_.back()->id;
}

bool Voices::say(Id id, std::string text) {
    const std::lock_guard lock(mutex_);
    Voice* voice = find(id);
    if (!voice || voice->lines.size() >= voice->speaker.most_lines)
        return false;
    ++voice->count;
    const std::string& name = voice->speaker.name;
    voice->lines.push_back(
        {std::move(text), name.empty() ? name : fmt::format("{}:{}", name, voice->count), true});
    interrupts_ = 0;
    something_new_.notify_all();
    return true;
}

void Voices::finish(Id id) {
    const std::lock_guard lock(mutex_);
    if (Voice* voice = find(id))
        voice->finished = true;
    something_new_.notify_all();
}

void Voices::close(Id id) {
    const std::lock_guard lock(mutex_);
    std::erase_if(voices_, [&](const auto& voice) { return voice->id == id; });
    something_new_.notify_all();
}

void Voices::interrupt() {
    const std::lock_guard lock(mutex_);
    ++interrupts_;
    interrupt_new_ = true;
    something_new_.notify_all();
}

std::optional<Voices::Next> Voices::take_next(std::int64_t goals_reached) {
    const std::lock_guard lock(mutex_);
    for (const auto& voice : voices_) {
        const auto line = voice->next_line(goals_reached);
        if (line == voice->lines.end())
            continue;
        Next next{voice->id, voice->speaker, std::move(*line)};
        voice->lines.erase(line);
        return next;
    }
    return std::nullopt;
}

void Voices::wait_for_next(std::int64_t goals_reached, std::chrono::milliseconds most) {
    std::unique_lock lock(mutex_);
    something_new_.wait_for(lock, most, [&] {
        return interrupt_new_ || std::any_of(voices_.begin(), voices_.end(), [&](const auto& voice) {
                   return voice->next_line(goals_reached) != voice->lines.end();
               });
    });
}

void Voices::let_wait(Id id, std::int64_t goal) {
    const std::lock_guard lock(mutex_);
    if (Voice* voice = find(id))
        voice->waits_for = goal;
}

bool Voices::put_first(Id id, const std::vector<std::string>& lines, const std::string& file) {
    const std::lock_guard lock(mutex_);
    Voice* voice = find(id);
    if (!voice)
        return true;
    if (voice->lines.size() + lines.size() > voice->speaker.most_lines) {
        voice->drop_sourced();
        return false;
    }
    for (std::size_t n = lines.size(); n-- > 0;)
        voice->lines.push_front({lines[n], fmt::format("{}:{}", file, n + 1), false});
    return true;
}

void Voices::drop_sourced(Id id) {
    const std::lock_guard lock(mutex_);
    if (Voice* voice = find(id))
        voice->drop_sourced();
}

void Voices::tell(Id id, const std::string& line, const Reply& reply) {
    std::function<void(const std::string&, const Reply&)> answer;
    {
        const std::lock_guard lock(mutex_);
        if (Voice* voice = find(id))
            answer = voice->speaker.answer;
    }
    if (answer)
        answer(line, reply);
}

void Voices::tell_others(Id id, const std::string& text) {
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

std::optional<int> Voices::take_interrupts() {
    const std::lock_guard lock(mutex_);
    return std::exchange(interrupt_new_, false) ? std::optional(interrupts_) : std::nullopt;
}

Voices::Retired Voices::retire_silent(std::int64_t goals_reached) {
    const std::lock_guard lock(mutex_);
    Retired retired;
    std::erase_if(voices_, [&](const auto& voice) {
        const bool silent = voice->finished && voice->lines.empty() && voice->waits_for <= goals_reached;
        retired.stops = retired.stops || (silent && voice->speaker.stops_at_end);
        retired.goes_on = retired.goes_on || (silent && voice->speaker.waits);
        retired.prompt = retired.prompt || (!silent && voice->speaker.keeps_run);
        return silent;
    });
    return retired;
}

bool Voices::none() const {
    const std::lock_guard lock(mutex_);
    return voices_.empty();
}

bool Voices::any_keeps_run() const {
    const std::lock_guard lock(mutex_);
    return std::any_of(voices_.begin(), voices_.end(),
                       [](const auto& voice) { return voice->speaker.keeps_run || voice->speaker.waits; });
}

} // namespace meltscope
