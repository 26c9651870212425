#pragma once

#include "run_outputs.hpp"
#include "terminal.hpp"

#include "meltscope/console/attach.hpp"
#include "meltscope/console/console.hpp"
#include "meltscope/console/line_editor.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace meltscope {

/// How a run is steered, as the command line says.
struct SteeringRequest {
    bool prompt = false;          ///< --repl
    std::filesystem::path script; ///< --script
    std::filesystem::path replay; ///< --replay
};

/// The console of a run and all that speaks to it: prompt or pipe, script, replay, attached consoles. Every
/// run has one, so that journal.txt is kept and others can attach.
class RunConsole {
  public:
    /// Throws UsageError for a script or a journal that cannot be read. `stop_request`: see ConsoleHost.
    RunConsole(const SteeringRequest& request, const RunPaths& paths, PreparedRun& prepared,
               RunOutputs& outputs, Terminal& terminal,
               std::function<std::optional<std::string>()> stop_request);
    ~RunConsole();
    RunConsole(const RunConsole&) = delete;
    RunConsole& operator=(const RunConsole&) = delete;

    CommandSource source() { return console_.source(); }

    /// Gives the terminal back; what is said from now on goes there as without a console. Lets attached
    /// consoles go.
    void finish();

    /// The error of a script or pipe that stopped the run.
    std::optional<std::string> script_error() const { return console_.script_error(); }

  private:
    void close();
    void replay(const std::filesystem::path& journal);
    void say_script(const std::filesystem::path& script);
    void open_prompt();
    void open_attach(const RunPaths& paths);

    Terminal& terminal_;
    Console console_;
    std::unique_ptr<AttachServer> server_;
    std::unique_ptr<LineEditor> editor_;
};

} // namespace meltscope
