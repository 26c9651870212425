#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace meltscope {

/// A journal that cannot be read; the message names file and line.
struct JournalError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// One line of a journal: what changed the run, and when.
struct JournalEntry {
    std::int64_t step = 0;
    double time = 0.0; ///< s, reads back bit for bit
    std::string command;
    /// A command of an earlier `at TIME`, carried out now. It is written as a comment: the entry of that `at`
    /// says all that a replay needs.
    bool waited = false;
    int line = 0; ///< in the text it was read from, from 1

    bool operator==(const JournalEntry& other) const {
        return step == other.step && time == other.time && command == other.command && waited == other.waited;
    }
};

/// `at step N t=T: command`, or `# at step N t=T: command` for what had waited, with the end of line.
std::string journal_line(const JournalEntry& entry);

/// Reads a journal. Other comments and empty lines are left out. `name` stands for the file in messages.
/// Throws JournalError for anything else, for steps that go back and for a time that is no number.
std::vector<JournalEntry> parse_journal(std::string_view text, const std::string& name);

} // namespace meltscope
