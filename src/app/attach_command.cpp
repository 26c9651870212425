#include "commands.hpp"
#include "exit_codes.hpp"

#include "meltscope/console/attach.hpp"

#include <filesystem>
#include <memory>

namespace meltscope {

void add_attach(CLI::App& program, Action& chosen) {
    struct Request {
        std::filesystem::path folder;
        bool watch = false;
    };
    auto request = std::make_shared<Request>();
    CLI::App* command = program.add_subcommand("attach", "Open a console on a run under way");
    command->add_option("DIR", request->folder, "Folder of the run")->required();
    command->add_flag("--watch", request->watch, "Look on only");
    command->footer("`detach` or Ctrl-D leaves the run as it is, `quit` stops it.\n"
                    "Examples:\n"
                    "  meltscope attach runs/quick_look\n"
                    "  echo status | meltscope attach runs/quick_look --watch");
    command->callback([request, &chosen] {
        chosen = [request] {
            try {
                return attach(request->folder, request->watch) ? exit_code::done : exit_code::usage;
            } catch (const AttachError& error) {
                throw UsageError(error.what());
            }
        };
    });
}

} // namespace meltscope
