#pragma once

#include "meltscope/console/commands.hpp"
#include "meltscope/console/console_state.hpp"

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace meltscope {

/// Whoever gives commands: the prompt, a script, a pipe, an attached console.
struct Speaker {
    std::string name;                 ///< for messages: a file name ...; empty: lines have no place
    bool waits = false;               ///< its next line comes after the goal of the last: scripts and pipes
    bool must_succeed = false;        ///< its first error stops the run
    bool keeps_run = false;           ///< at its end the run waits for this speaker: the prompt
    bool stops_at_end = false;        ///< when it has said all, the run stops: pipes
    bool may_change = true;           ///< false: only commands that look
    std::size_t most_lines = 100'000; ///< that may wait
    /// Called on the solver's thread for every line that was carried out, and for what the run itself has to
    /// say (empty line). Must not wait.
    std::function<void(const std::string& line, const Reply& reply)> answer;
};

class Voices;

/// The console of a run: takes lines from any thread, carries them out on the solver's thread between steps.
///
/// All lines go through one queue a speaker. The run loop calls apply() through source(); while the run is
/// paused that call waits for further lines.
class Console {
  public:
    using Id = int;

    /// `paused`: the run waits for a command before its first step.
    Console(ConsoleHost host, bool paused);
    ~Console();
    Console(const Console&) = delete;
    Console& operator=(const Console&) = delete;

    /// Has the run do again what a journal says. Throws JournalError if the text is no journal. Before the
    /// first step.
    void replay(const std::string& journal, const std::string& name);

    // From any thread.
    Id open(Speaker speaker);
    /// Takes a line; false if that speaker has too many waiting.
    bool say(Id speaker, std::string line);
    /// Nothing more will come; what was said is still carried out.
    void finish(Id speaker);
    /// Forgets the speaker and what it said.
    void close(Id speaker);
    /// As a command `pause`, then, if nothing was said in between, a stop with a checkpoint.
    void interrupt();
    /// Where the run is, one line for a status display; at most one step old.
    std::string status_line() const;
    /// What completion has to know.
    CompletionNames completion_names() const;

    /// For the run loop. Throws JournalError if a replay departs from its journal.
    CommandSource source();
    /// The message if the first error of a script or pipe stopped the run.
    std::optional<std::string> script_error() const { return script_error_; }
    /// To be called when the run has ended: replays that were not carried out to their end; empty if all was.
    std::string left_of_replay() const;

  private:
    void apply(Run& run);
    void begin(Run& run);
    void replay_due(Run& run);
    bool interrupted(Run& run);
    bool do_next_line(Run& run);
    void retire_silent_voices(Run& run);
    bool waits_for_nobody(const Run& run) const;
    void reach_goal(Run& run);
    void tell_all(const std::string& text);
    void publish(const Run& run);
    void publish_names(const Run& run);

    ConsoleState state_;
    bool begun_ = false;
    std::int64_t goals_reached_ = 0; ///< all goals up to this number are done with
    bool said_end_ = false;
    std::vector<JournalEntry> replay_;
    std::string replay_name_;
    std::size_t replayed_ = 0;
    std::optional<std::string> script_error_;

    std::unique_ptr<Voices> voices_;

    mutable std::mutex mutex_; ///< for what follows
    std::string status_;
    CompletionNames names_;
};

} // namespace meltscope
