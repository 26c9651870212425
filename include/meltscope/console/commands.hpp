#pragma once

#include "meltscope/console/arguments.hpp"
#include "meltscope/console/console_state.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace meltscope {

/// What a word of a command's arguments can be, for completion.
enum class Completes { nothing, parameter, command, file, view, field, laser, path_verb, layer_word };

/// Whom a command concerns.
enum class Effect {
    looks,    ///< changes nothing: watchers may use it
    controls, ///< the going of the run, not its state
    changes   ///< the run
};

/// What a handler works with.
struct Call {
    ConsoleState& console;
    Run& run;
    Arguments& arguments;
    std::string journal; ///< the handler's: the command as a replay will find it; empty if nothing changed
    bool starts = false; ///< the handler's: set the run going
    /// The words are to be judged, and nothing is to be done that cannot be undone by putting the steering
    /// and the pictures' settings back.
    bool rehearsal = false;
};

/// One row of the table from which parser, help, completion and manual come.
struct Command {
    std::string name;
    std::string syntax;  ///< arguments
    std::string help;    ///< one or a few sentences
    std::string example; ///< whole lines
    Completes completes = Completes::nothing;
    Effect effect = Effect::looks;
    std::string (*handler)(Call&) = nullptr; ///< returns the text of the reply; throws what is wrong
};

/// All commands, in the order of the manual.
const std::vector<Command>& command_table();

/// The command that `word` is or unambiguously begins. Throws CommandError.
const Command& find_command(const std::string& word);

/// What `help` and `help COMMAND` say.
std::string help_text();
std::string help_text(const Command& command);

/// The manual in Markdown, made from the table and the parameters.
std::string console_manual();

/// What completion has to know of a run.
struct CompletionNames {
    std::vector<std::string> parameters;
    std::vector<std::string> fields;
    std::vector<std::string> lasers;
    std::vector<std::string> materials;
};

/// The words that may stand at the end of `line`, which is the text before the cursor. Folders end in a
/// slash.
std::vector<std::string> completions(std::string_view line, const CompletionNames& names);

/// Words that may follow `path`, those between its values, and those of `layer`.
const std::vector<std::string>& path_verbs();
const std::vector<std::string>& path_keywords();
const std::vector<std::string>& layer_keywords();

/// A waiting command as a journal keeps it: `save` and `snapshot` without their file, since a journal or a
/// checkpoint from elsewhere must not say what is written where. Other lines as they are.
std::string without_file_to_write(const std::string& line);

/// The file that a command is to write, if one is named. Throws CommandError if the command is a journal's.
std::filesystem::path file_to_write(Call& call);

/// A `path load` or `path append` with the rows of its file in it, for those that wait; other lines as they
/// are.
std::string with_path_file_inlined(const std::string& line);

/// The command `adopt` that a journal holds for a run taken up with changes of its scenario, `scenario` as
/// text, or under another one. Files that these name are not in the journal: a replay refuses them.
std::string adoption(const std::vector<std::string>& changes, const std::filesystem::path& other_scenario,
                     const std::string& scenario);

/// Takes over what the changed scenario says of pictures, for the keys that these KEY=VALUE words name.
void adopt_picture_settings(ConsoleState& console, const std::vector<std::string>& words);

// Handlers by subject; see command_table.
std::string do_status(Call&);
std::string do_run(Call&);
std::string do_pause(Call&);
std::string do_continue(Call&);
std::string do_step(Call&);
std::string do_until(Call&);
std::string do_at(Call&);
std::string do_land(Call&);
std::string do_quit(Call&);

std::string do_get(Call&);
std::string do_set(Call&);
std::string do_list(Call&);
std::string do_power(Call&);
std::string do_speed(Call&);
std::string do_spot(Call&);
std::string do_on(Call&);
std::string do_off(Call&);
std::string do_view(Call&);
std::string do_field(Call&);

std::string do_path(Call&);

std::string do_snapshot(Call&);
std::string do_probe(Call&);
std::string do_pool(Call&);
std::string do_energy(Call&);

std::string do_save(Call&);
std::string do_restore(Call&);
std::string do_layer(Call&);
std::string do_adopt(Call&);

std::string do_record(Call&);
std::string do_history(Call&);
std::string do_source(Call&);
std::string do_help(Call&);
std::string do_detach(Call&);

} // namespace meltscope
