#pragma once

#include "meltscope/console/journal.hpp"
#include "meltscope/run/powder_layer.hpp"
#include "meltscope/run/run_loop.hpp"

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace meltscope {

/// What the pictures show; steerable.
struct RenderSettings {
    std::vector<std::string> views{"overview"};
    std::string field = "temperature";
    std::optional<std::array<double, 2>> color_range; ///< K; unset: chosen at the first picture
    std::string colormap = "inferno";
    std::string background = "dark";

    bool operator==(const RenderSettings&) const = default;
};

/// What the program lends to its console. Functions may be empty; the commands that need them then say so.
struct ConsoleHost {
    std::filesystem::path folder;                   ///< run folder, for journal.txt; empty: no file is kept
    std::string scenario;                           ///< the resolved scenario, as checkpoints hold it
    RunParameters parameters;                       ///< that the scenario asks for
    std::optional<PowderLayer> layer;               ///< of the scenario, the pattern for new ones
    RenderSettings render;                          ///< at the start
    std::vector<std::string> fields{"temperature"}; ///< that pictures can show

    std::function<void(const RenderSettings&)> set_render;
    /// Makes one picture of a view at once.
    std::function<void(const Run&, const std::string& view, const std::filesystem::path& png)> write_picture;
    /// Called after the run was put back to a time, s: outputs at or after it no longer hold.
    std::function<void(const Run&)> restored;
    /// Has the run go on under its scenario with KEY=VALUE changes, as if it had been taken up so, and brings
    /// scenario, parameters, layer and render up to date. Throws what is wrong, the run being as it was.
    std::function<void(Run&, ConsoleHost&, const std::vector<std::string>& changes)> adopt;
    std::string adopted; ///< under which `adopt` the run was taken up, for its journal; empty: none
    /// Why the program wants the run to stop, if it does. Asked for while the console waits.
    std::function<std::optional<std::string>()> stop_request;
};

/// A command that waits for its time.
struct WaitingCommand {
    double time = 0.0; ///< s
    std::string command;
    bool must_succeed = false; ///< from a script: its failure stops the run
};

/// How far the run is to go before it pauses.
struct Goal {
    std::int64_t number = 0; ///< goals are counted, so that a script can wait for its own
    std::optional<std::int64_t> step;
    std::optional<double> time; ///< s: the first step that ends at or after it
};

/// All that a console knows besides the run. Belongs to the thread of the solver.
struct ConsoleState {
    ConsoleHost host;
    RenderSettings render;

    bool running = true;
    bool leaves = false; ///< the run is at its end and nobody wants to look at it any more
    Goal goal;
    std::vector<WaitingCommand> waiting; ///< by time, then in the order of their coming
    std::vector<double> landings;        ///< s, times at which a step ends, ascending

    std::vector<std::string> lines;   ///< carried out so far, for `history`
    std::filesystem::path recording;  ///< where `record` writes; empty: nowhere
    std::vector<std::string> sourced; ///< lines that the last command wants carried out next
    std::string sourced_from;         ///< the file that they are from
    bool must_succeed = false;        ///< the command is from a script
    bool from_journal = false;        ///< the command is from a journal
    std::size_t journal_written = 0;  ///< characters of the journal that are in journal.txt

    explicit ConsoleState(ConsoleHost host_) : host(std::move(host_)), render(host.render) {}
};

/// What a command came to.
struct Reply {
    bool ok = true;
    std::string text;    ///< for people; may be empty, may have several lines
    bool starts = false; ///< set the run going: a script waits for the new goal
};

/// Carries one line out. Never throws for what is wrong with the line: the reply says it, and the run is as
/// it was. What changed the run is in run.journal and, with a run folder, in journal.txt.
Reply execute(ConsoleState& console, Run& run, std::string_view line);

/// True when nothing of the run is left to be stepped.
bool at_end_of_run(const Run& run);

/// Takes up run.journal as a checkpoint holds it: what waits goes on waiting, what pictures show is set
/// again. A stop that ended the run is taken back. Then writes journal.txt anew. Throws JournalError.
void take_up_journal(ConsoleState& console, Run& run);

/// Notes in the journal under which changes of its scenario the run was taken up, if any.
void note_adoption(ConsoleState& console, Run& run);

/// Carries out what has waited for the present time; the replies.
std::vector<Reply> execute_due(ConsoleState& console, Run& run);

/// The next time that a command waits for or a step has to end at, s.
double next_landing(const ConsoleState& console, double time);

/// Notes in the journal that the next steps are aimed at run.until, if no output has them aimed there anyway.
void note_landing(ConsoleState& console, Run& run);

/// Stops the run, with a checkpoint, and notes it in the journal. A run at its end is left as it is, done.
void stop(ConsoleState& console, Run& run, const std::string& reason);

} // namespace meltscope
