#include "meltscope/console/journal.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace meltscope {
namespace {

/// Takes `part` off the front of `text`, or returns false.
bool take(std::string_view& text, std::string_view part) {
    if (!text.starts_with(part))
        return false;
    text.remove_prefix(part.size());
    return true;
}

template <class Number>
bool take_number(std::string_view& text, Number& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc())
        return false;
    text.remove_prefix(std::size_t(end - text.data()));
    return true;
}

bool parse_entry(std::string_view text, JournalEntry& entry) {
    const bool form = take(text, "at step ") && take_number(text, entry.step) && take(text, " t=") &&
                      take_number(text, entry.time) && take(text, ": ");
    entry.command = text;
    return form && text.find_first_not_of(" \t") != std::string_view::npos && std::isfinite(entry.time);
}

} // namespace

std::string journal_line(const JournalEntry& entry) {
    return fmt::format("{}at step {} t={}: {}\n", entry.waited ? "# " : "", entry.step, entry.time,
                       entry.command);
}

std::vector<JournalEntry> parse_journal(std::string_view text, const std::string& name) {
    std::vector<JournalEntry> entries;
    for (int number = 1; !text.empty(); ++number) {
        const std::size_t end = text.find('\n');
        std::string_view line = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        while (line.ends_with('\r')) // all of them, or what is written would read back as another
            line.remove_suffix(1);
        JournalEntry entry;
        entry.line = number;
        entry.waited = line.starts_with("# ");
        const bool comment = line.starts_with('#');
        if (line.find_first_not_of(" \t") == std::string_view::npos)
            continue;
        const bool is_entry = parse_entry(entry.waited ? line.substr(2) : line, entry);
        if (!is_entry && comment)
            continue;
        if (!is_entry)
            throw JournalError(fmt::format(
                "{}:{}: not a line of a journal, which is `at step N t=TIME: command`", name, number));
        if (!entries.empty() && (entry.step < entries.back().step || entry.time < entries.back().time))
            throw JournalError(fmt::format("{}:{}: the step or the time goes back", name, number));
        entries.push_back(std::move(entry));
    }
    return entries;
}

} // namespace meltscope
