#include "commands.hpp"
#include "exit_codes.hpp"
#include "run_report.hpp"
#include "text.hpp"

#include "meltscope/io/atomic_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace meltscope {
namespace {

int report_on(const std::filesystem::path& folder) {
    const RunPaths paths{folder};
    if (!std::filesystem::exists(paths.scenario()) && !std::filesystem::exists(paths.summary()) &&
        !std::filesystem::exists(paths.melt_pool_table()))
        throw UsageError(
            fmt::format("{} holds no run (run.toml, run.json or melt_pool.csv): give the folder of a run",
                        folder.string()));
    const std::string page =
        report_page(paths, [](const std::string& text) { show(stderr, fmt::format("warning: {}\n", text)); });
    write_file_atomically(paths.report(), page);
    print_result(fmt::format("{}\n", paths.report().string()));
    return exit_code::done;
}

} // namespace

void add_report(CLI::App& program, Action& chosen) {
    auto folder = std::make_shared<std::filesystem::path>();
    CLI::App* report = program.add_subcommand(
        "report", "Write report.html: movie, plots, ledger, parameters and journal in one file");
    report->add_option("DIR", *folder, "Run folder")->required();
    report->footer("The page needs no other file and no network.\n"
                   "Example:\n  meltscope report runs/in625_single_track");
    report->callback([folder, &chosen] { chosen = [folder] { return report_on(*folder); }; });
}

} // namespace meltscope
