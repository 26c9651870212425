#pragma once

#include "meltscope/console/line_editor.hpp"

#include "wake_pipe.hpp"

#include <atomic>
#include <memory>
#include <string>

namespace meltscope {

/// One way to read lines and to print text meanwhile, on a thread of its own.
class Prompt {
  public:
    virtual ~Prompt() = default;
    virtual void print(const std::string& text) = 0;
};

/// Reads lines as they come: from a pipe, a file or a terminal that cannot be edited.
std::unique_ptr<Prompt> make_plain_prompt(std::string prompt, LineEditor::Callbacks callbacks);

/// Edits lines with libedit. Null if standard input and output are no terminal that could.
std::unique_ptr<Prompt> make_edited_prompt(std::string prompt, std::filesystem::path history,
                                           LineEditor::Callbacks callbacks);

/// Puts text on standard output at once. A terminal that is gone takes nothing; its end of input ends the
/// prompt.
void to_terminal(const std::string& text);

/// Waits until standard input can be read or the pipe wakes; true if it can be read.
bool wait_for_input(WakePipe& pipe, int milliseconds);

/// The signals of a terminal, as long as one lives: only one at a time. A handler can reach nothing but
/// these flags and the end of a pipe.
class TerminalSignals {
  public:
    /// Ctrl-C, and, if `resizes`, a change of the window's size.
    TerminalSignals(const WakePipe& pipe, bool resizes);
    ~TerminalSignals();
    TerminalSignals(const TerminalSignals&) = delete;
    TerminalSignals& operator=(const TerminalSignals&) = delete;

    /// Whether it came since the last call.
    bool take_interrupt();
    bool take_resize();

  private:
    struct Before;
    std::unique_ptr<Before> before_;
};

} // namespace meltscope
