#include "meltscope/console/commands.hpp"
#include "meltscope/console/parameters.hpp"

#include <fmt/format.h>

namespace meltscope {
namespace {

std::string with_syntax(const Command& command) {
    return command.name + (command.syntax.empty() ? "" : " " + command.syntax);
}

/// A | would end a cell of the table.
std::string escaped(std::string text) {
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
        text.insert(at, 1, '\\');
    return text;
}

/// The first sentence, without its full stop.
std::string in_short(const std::string& help) {
    const std::string sentence = help.substr(0, std::min(help.find(". "), help.find("; ")));
    return sentence.substr(0, sentence.size() - (sentence.ends_with('.') ? 1 : 0));
}

/// Breaks a text at blanks into rows that fit any terminal; those after the first are indented.
std::string wrapped(const std::string& text, std::size_t indent) {
    constexpr std::size_t columns = 79;
    std::string rows, row;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t begin = text.find_first_not_of(' ', at);
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        const std::string word = text.substr(at, end - at); // with the blanks before it
        if (row.size() + word.size() > columns && !row.empty()) {
            rows += row + '\n';
            row = std::string(indent, ' ') + text.substr(begin, end - begin);
        } else {
            row += word;
        }
        at = end;
    }
    return rows + row;
}

} // namespace

std::string help_text() {
    std::string text;
    for (const Command& command : command_table())
        text += wrapped(fmt::format("{:<9} {}", command.name, in_short(command.help)), 10) + '\n';
    return text + "help COMMAND tells more. Unambiguous beginnings are enough; Tab completes.";
}

std::string help_text(const Command& command) {
    return fmt::format("{}\n{}\n  for example: {}", wrapped(with_syntax(command), command.name.size() + 1),
                       wrapped("  " + command.help, 2), command.example);
}

std::string console_manual() {
    std::string text = R"(# The console

<!-- Made by meltscope_console_manual from the table of commands; a test compares them. -->

The same commands work at the prompt of `meltscope run --repl`, from `--script FILE`, from a pipe and through
`meltscope attach DIR`. They take effect at the next step. Words may be shortened to an unambiguous beginning. Quantities are
numbers in SI units or have a unit: `85e-6`, `85um`, `85 um`. Quotes, "..." or '...', keep blanks together; `#` begins a comment.

## Commands

| command | what it does | example |
|---|---|---|
)";
    for (const Command& command : command_table())
        text += fmt::format("| `{}` | {} | `{}` |\n", escaped(with_syntax(command)), escaped(command.help),
                            escaped(command.example));
    text += R"(
## Parameters

With several lasers the names are `laser.NAME.power` and so on.

| parameter | values | what it is |
|---|---|---|
)";
    for (const Parameter& parameter : parameters_of({Laser{}}))
        text += fmt::format("| `{}` | {} | {} |\n", parameter.name, parameter.values, parameter.help);
    return text + R"(
## Prompt, scripts and pipes

At the prompt the run waits for `run`, and again when it has reached its end. The prompt can be used while the run goes on: what
is typed takes effect at the next step. Tab completes, arrows bring back what was typed, also in earlier sessions (kept in
`~/.local/state/meltscope/history`). Ctrl-C drops the line; on an empty line it pauses the run, and again stops it with a checkpoint.
Ctrl-D on an empty line is `quit`. A terminal that goes away stops the run with a checkpoint. On a dumb terminal lines are not edited
and Ctrl-C pauses at once.

In scripts and pipes `run`, `step`, `until` and `continue` are waited for before the next line is read. After a script the run goes
on to its end; at the end of a pipe it stops there. The first error of a script or pipe stops the run with a checkpoint; the exit
code is 2.

`meltscope attach DIR` opens a console on a run under way, with the same prompt. The first of those attached can change the run, the
others look on: they see what is said and may use the commands that only show something. `detach` or Ctrl-D leaves the run as it is,
`quit` stops it. The socket in the run folder is its owner's alone. Whoever sends what is no text or more than 4096 characters in a
line, or does not read what it is told (256 kB), is cut off; the solver never waits for a client.

## The journal

Everything that changed the run is in `journal.txt`, as `at step N t=TIME: command`, with values in SI and the rows of path files. A
replay (`meltscope run SCENARIO --replay journal.txt`) carries each command out at its step and checks the time there; its end state
equals that of the run bit for bit, with any number of threads.

- A pause leaves the steps as they are: `until` and `run TIME` pause at the first step at or after the time. Only what is in the journal
  moves the ends of steps: output intervals, `at`, `land`.
- `at` is noted when it is given; when its command is carried out, a comment says so.
- `quit` is noted as the end of the journal, and taken back when the run is taken up again.
- A run taken up by `--restart CHECKPOINT --set KEY=VALUE` has the changes there as `adopt`, with a fingerprint of the scenario before
  them: a replay needs the scenario that the run began with, which is the `run.toml` of its folder, and is refused under another one.
  Under another scenario file, or with changes that name files, only the rest can be replayed, from that checkpoint.
- `restore` puts the journal back to that of the checkpoint.
- A journal names no file to write: `at T save FILE` is noted as `at T save`, which saves into the run folder when a replay or a restart
  comes to it. A journal from elsewhere that names one is refused.
- A checkpoint holds the journal so far, so that a run taken up from it goes on with it, with what waits, and with its pictures' settings.
)";
}

} // namespace meltscope
