#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace meltscope {

/// Where the history of typed lines is kept: $XDG_STATE_HOME/meltscope/history, by default under
/// ~/.local/state. Empty without a home.
std::filesystem::path history_file();

class Prompt;

/// A prompt on standard input and output, on a thread of its own, so that typing never waits for the solver.
///
/// On a terminal lines are edited with libedit, and print() puts text above the line being typed. On a dumb
/// terminal or a pipe lines are read as they come. The object owns the terminal until it is destroyed.
class LineEditor {
  public:
    struct Callbacks {
        /// False: it cannot be taken now. A line from a pipe is then kept and given again a little later.
        std::function<bool(const std::string& line)> line;
        std::function<void()> interrupt; ///< Ctrl-C at a terminal; on an empty line if lines are edited
        std::function<void()> end;       ///< end of input: Ctrl-D on an empty line, or the end of a pipe
        /// The words that may stand at the end of the text before the cursor; may be empty.
        std::function<std::vector<std::string>(std::string_view)> complete;
        std::function<std::string()> status; ///< shown at the right of the prompt; may be empty
    };

    /// `history`: file of lines typed earlier; empty: none is kept. Starts reading.
    LineEditor(std::string prompt, std::filesystem::path history, Callbacks callbacks);
    /// Ends the thread and puts the terminal back.
    ~LineEditor();
    LineEditor(const LineEditor&) = delete;
    LineEditor& operator=(const LineEditor&) = delete;

    /// Prints whole lines above the prompt. From any thread; does not wait for a terminal that is edited.
    void print(const std::string& text);

  private:
    std::unique_ptr<Prompt> prompt_;
};

} // namespace meltscope
