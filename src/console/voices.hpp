#pragma once

#include "meltscope/console/console.hpp"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace meltscope {

/// A line that somebody has said.
struct SpokenLine {
    std::string text;
    std::string place; ///< FILE:LINE, empty for people
    bool given = true; ///< false: from a sourced file
};

/// Those who speak to a console, each with the lines that wait to be carried out, and Ctrl-C. Every function
/// may be called from any thread; answers are given without holding the lock.
class Voices {
  public:
    using Id = Console::Id;

    Id open(Speaker speaker);
    bool say(Id id, std::string text);
    void finish(Id id);
    void close(Id id);
    void interrupt();

    struct Next {
        Id id = 0;
        Speaker speaker;
        SpokenLine line;
    };
    /// The line that is to be carried out next, taken out of its queue. Goals up to `goals_reached` are done
    /// with.
    std::optional<Next> take_next(std::int64_t goals_reached);
    /// Waits until there is one, or Ctrl-C, but not much longer than `most`.
    void wait_for_next(std::int64_t goals_reached, std::chrono::milliseconds most);

    /// Its next lines wait until this goal is reached.
    void let_wait(Id id, std::int64_t goal);
    /// Puts the lines of a file before the others. False if too many would wait; then none are left of any
    /// file.
    bool put_first(Id id, const std::vector<std::string>& lines, const std::string& file);
    /// What is left of a sourced file is not carried out.
    void drop_sourced(Id id);

    void tell(Id id, const std::string& line, const Reply& reply);
    /// News for all but one (0: for all).
    void tell_others(Id id, const std::string& text);

    /// How often Ctrl-C came since the last line was said, if it came since the last call.
    std::optional<int> take_interrupts();

    /// What follows from those that have said all; they are forgotten.
    struct Retired {
        bool stops = false;   ///< one at whose end the run stops
        bool goes_on = false; ///< one after whom the run goes on
        bool prompt = false;  ///< a prompt is still open
    };
    Retired retire_silent(std::int64_t goals_reached);

    bool none() const;
    /// Whether the run may not end by itself: a prompt is open, or a script has more to say.
    bool any_keeps_run() const;

  private:
    struct Voice {
        Id id = 0;
        Speaker speaker;
        std::deque<SpokenLine> lines;
        int count = 0; ///< lines taken so far
        bool finished = false;
        std::int64_t waits_for = 0; ///< number of a goal; 0: none

        /// The line that may be carried out now; lines.end() if none.
        std::deque<SpokenLine>::iterator next_line(std::int64_t goals_reached);
        void drop_sourced();
    };

    Voice* find(Id id); ///< needs the mutex

    mutable std::mutex mutex_; ///< for what follows
    std::condition_variable something_new_;
    std::vector<std::unique_ptr<Voice>> voices_;
    Id next_id_ = 1;
    int interrupts_ = 0;
    bool interrupt_new_ = false;
};

} // namespace meltscope
