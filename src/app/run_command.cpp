#include "commands.hpp"
#include "disk_need.hpp"
#include "exit_codes.hpp"
#include "machine.hpp"
#include "run_console.hpp"
#include "run_outputs.hpp"
#include "run_setup.hpp"
#include "signals.hpp"
#include "step_watch.hpp"
#include "stops.hpp"
#include "text.hpp"

#include "meltscope/run/possible_state.hpp"
#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/scenario/setup.hpp"
#include "meltscope/scenario/units.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <filesystem>
#include <memory>

namespace meltscope {
namespace {

struct RunRequest {
    std::filesystem::path scenario; ///< empty: that of the checkpoint
    std::filesystem::path output;   ///< empty: by default
    std::vector<std::string> overrides;
    std::string until; ///< a time with its unit; empty: the scenario's end
    std::int64_t steps = 0;
    int threads = 0; ///< 0: as many as OpenMP gives
    std::filesystem::path restart;
    SteeringRequest steering;
    bool no_render = false;
    std::string backend = "auto";
    std::string wall_limit;
    bool overwrite = false, quiet = false, verbose = false;
};

std::optional<double> time_of(const std::string& text) {
    if (text.empty())
        return std::nullopt;
    try {
        std::size_t used = 0;
        const double seconds = std::stod(text, &used);
        if (used == text.size())
            return seconds; // a number alone is in seconds, as in scenarios
    } catch (const std::logic_error&) {
    }
    try {
        return to_si(text, quantity::time);
    } catch (const UnitError& error) {
        throw UsageError(fmt::format("--until {}: {}", text, error.what()));
    }
}

double wall_limit_of(const std::string& text) {
    if (text.empty())
        return never;
    const auto seconds = parse_clock_time(text);
    if (!seconds)
        throw UsageError(fmt::format("--wall-limit {}: expected HH:MM:SS, for example 01:30:00", text));
    return *seconds;
}

viz::Backend backend_of(const RunRequest& request) {
    if (request.no_render)
        return viz::Backend::none;
    try {
        return viz::backend_from_name(request.backend);
    } catch (const viz::VizError& error) {
        throw UsageError(error.what());
    }
}

/// Where the outputs go, and whether the run goes on in the folder of the checkpoint that it is taken up
/// from.
struct OutputFolder {
    std::filesystem::path path;
    bool goes_on = false;
};

OutputFolder output_folder(const RunRequest& request) {
    const auto own = request.restart.empty() ? std::nullopt : folder_of_checkpoint(request.restart);
    OutputFolder folder;
    if (!request.output.empty())
        folder.path = request.output;
    else if (own)
        folder.path = *own;
    else {
        const std::filesystem::path& named = request.scenario.empty() ? request.restart : request.scenario;
        if (named.stem().empty() || named.stem() == "..") // ...toml: runs/.. is no run folder
            throw UsageError(
                fmt::format("{} gives no name to a run folder: name one with --output", named.string()));
        folder.path = std::filesystem::path("runs") / named.stem();
    }
    std::error_code not_there;
    folder.goes_on = own && std::filesystem::equivalent(folder.path, *own, not_there);
    return folder;
}

void describe(const PreparedRun& prepared, const std::filesystem::path& folder, int threads,
              Terminal& terminal) {
    const Simulation& simulation = prepared.run.simulation;
    terminal.note(version_text());
    if (prepared.resumed_at)
        terminal.say(
            fmt::format("going on at step {}, t = {}", simulation.step, in_si(simulation.time, "s")));
    terminal.say(fmt::format("{}: {} particles, {} nodes, {} thread{}, into {}",
                             prepared.scenario.title.empty() ? "run" : prepared.scenario.title,
                             simulation.particles.count(), simulation.grid.node_count(), threads,
                             threads == 1 ? "" : "s", folder.string()));
    if (simulation.exchange) {
        const ExchangeCost& cost = simulation.exchange->cost;
        terminal.note(
            fmt::format("radiative exchange: {} patches, {} factors, {:.1f} MB, {} rays in {:.2f} s",
                        cost.patches, cost.factors, double(cost.bytes) / 1e6, cost.rays, cost.seconds));
    }
}

void print_ledger(const Ledger& ledger, Terminal& terminal) {
    terminal.say("Energy ledger");
    for (const auto& [words, energy] : in_words(ledger))
        terminal.say(fmt::format("  {:<30} {:>13.6g} J", words, energy));
    terminal.say(fmt::format("  {:<30} {:>13.1e}", "relative residual", ledger.relative_residual()));
}

void print_phases(const Run& run, std::int64_t steps, Terminal& terminal) {
    const WallSeconds& wall = run.wall;
    terminal.note(fmt::format(
        "seconds: solver {:.2f}, level set {:.2f}, in-situ {:.2f}, tables and checkpoints {:.2f}; "
        "peak memory {:.2f} GB",
        wall.solver, wall.level_set, wall.in_situ, wall.output, peak_memory() * 1e-9));
    if (steps > 0 && wall.solver > 0.0)
        terminal.say(fmt::format(
            "{} steps in {:.1f} s, {:.1f} M particle-steps/s", steps, wall.solver + wall.level_set,
            1e-6 * double(steps) * double(run.simulation.particles.count()) / wall.solver));
}

/// Says what the run will put on the disk, and warns if there is less room.
void tell_disk_need(const PreparedRun& prepared, const std::filesystem::path& folder, bool draws,
                    Terminal& terminal) {
    const DiskNeed need = disk_need(prepared, draws);
    const double room = free_disk(folder);
    terminal.say(in_words(need));
    if (room >= 0.0 && need.sum() > room)
        terminal.warn(fmt::format("the disk may be too small, {} are free where {} are needed: fewer outputs "
                                  "(output.every), fewer particles in them or "
                                  "output.compression = \"lz4\" need less",
                                  in_si(room, "B"), in_si(need.sum(), "B")));
}

/// Says what is different from the scenario that a checkpoint was made under.
void tell_changes(const std::vector<std::string>& changes, Terminal& terminal) {
    for (const std::string& change : changes) {
        terminal.say(fmt::format("changed since the checkpoint: {}", change));
        if (change.starts_with("body["))
            terminal.warn("a changed body has no effect: the particles are those of the checkpoint");
    }
}

/// Keeps the state in which the solution has become impossible; says where.
std::string state_kept(const Run& run, const RunOutputs& outputs) {
    try {
        return fmt::format(
            "The state after that step is in {} for a look at it (meltscope info); go on from a "
            "checkpoint before it",
            outputs.keep_for_inspection(run).string());
    } catch (const std::exception& error) {
        return fmt::format("The state after that step could not be kept: {}", error.what());
    }
}

RunOutcome run_or_keep_state(Run& run, const RunConnections& connections, const RunOutputs& outputs) {
    try {
        return run_to_end(run, connections);
    } catch (const SolutionError& error) {
        throw SolutionError(fmt::format("{}. {}", error.what(), state_kept(run, outputs)));
    }
}

/// Steps the run; run.json says how it ended, whatever happens.
RunOutcome step_through(Run& run, const RunConnections& connections, RunOutputs& outputs,
                        Terminal& terminal) {
    try {
        return run_or_keep_state(run, connections, outputs);
    } catch (const std::exception& error) {
        try {
            outputs.finish(run, "failed", error.what());
        } catch (const std::exception& further) { // what ended the run may keep this from being written, too
            terminal.warn(further.what());
        }
        throw;
    }
}

int execute(const RunRequest& request) {
    Stops stops(wall_limit_of(request.wall_limit));
    if (request.scenario.empty() && request.restart.empty())
        throw UsageError("a SCENARIO is required, or a checkpoint to go on from (--restart)");
    const std::optional<double> until = time_of(request.until);
    const viz::Backend backend = backend_of(request);
    if (request.threads > 0)
        omp_set_num_threads(request.threads);
    const int threads = omp_get_max_threads();
    watch_signals();

    Terminal terminal(request.quiet     ? Terminal::Volume::quiet
                      : request.verbose ? Terminal::Volume::verbose
                                        : Terminal::Volume::normal);
    const auto scenario_file =
        request.scenario.empty() ? std::nullopt : std::optional<std::filesystem::path>(request.scenario);
    for (const auto& file : {request.steering.script, request.steering.replay})
        if (!file.empty() && !std::filesystem::is_regular_file(file))
            throw UsageError(fmt::format("{} cannot be read", file.string()));
    // The folder is claimed before the long work of filling the domain, the input is judged before both.
    const OutputFolder folder = output_folder(request);
    InputOfRun input = read_input(scenario_file, request.restart, request.overrides);
    const auto changes =
        input.original ? scenario_changes(*input.original, input.scenario) : std::vector<std::string>();
    const RunFolder claim(folder.path, folder.goes_on      ? ExistingRun::resume
                                       : request.overwrite ? ExistingRun::overwrite
                                                           : ExistingRun::refuse);
    PreparedRun prepared = prepare_run(std::move(input));
    keep_freed_memory(); // not what only the set-up needed
    terminal.log_to(claim.paths().log(), folder.goes_on);
    if (claim.stale_owner())
        terminal.note(fmt::format("the run of process {} in this folder ended without cleaning up",
                                  *claim.stale_owner()));

    Run& run = prepared.run;
    run.until = until;
    const std::int64_t first_step = run.simulation.step;
    if (request.steps > 0)
        run.last_step = first_step + request.steps;
    describe(prepared, folder.path, threads, terminal);
    tell_changes(changes, terminal);

    for (const std::string& note : scenario_notes(prepared.scenario))
        terminal.note(note);
    tell_disk_need(prepared, folder.path, backend != viz::Backend::none, terminal);
    RunOutputs outputs(claim.paths(), prepared, backend, threads, terminal);
    StepWatch watch(terminal, outputs);
    RunConsole console(request.steering, claim.paths(), prepared, outputs, terminal,
                       [&] { return stops.request(); });
    RunConnections connections;
    connections.commands.push_back(scheduled_layers(prepared.scenario.layers));
    connections.commands.push_back(stops.source(outputs, terminal));
    connections.commands.push_back(console.source());
    connections.after_step.push_back([&](const Run&) { stops.after_step(); });
    connections.after_step.push_back([&](const Run& r) { outputs.after_step(r); });
    connections.after_step.push_back([&](const Run& r) { watch.after_step(r); });
    connections.sinks = outputs.sinks();
    connections.sinks.push_back(watch.sink());

    const RunOutcome outcome = step_through(run, connections, outputs, terminal);
    console.finish();
    terminal.end_progress();
    balance(run.simulation);
    const bool stopped = outcome == RunOutcome::stopped;
    outputs.finish(run, stopped ? "stopped" : "done", stopped ? *run.stop_reason : "",
                   stopped && stops.out_of_time() ? RunOutputs::Movies::leave : RunOutputs::Movies::make);

    if (stopped)
        terminal.say(fmt::format("Stopped at step {}, t = {}: {}.", run.simulation.step,
                                 in_si(run.simulation.time, "s"), *run.stop_reason));
    print_ledger(run.simulation.ledger, terminal);
    print_phases(run, run.simulation.step - first_step, terminal);
    terminal.say("Results");
    for (const std::string& line : outputs.list())
        terminal.say(line);
    if (const auto error = console.script_error())
        throw UsageError(*error);
    return stopped ? exit_code::stopped : exit_code::done;
}

} // namespace

void add_run(CLI::App& program, Action& chosen) {
    auto request = std::make_shared<RunRequest>();
    CLI::App* run = program.add_subcommand("run", "Run a scenario");
    run->add_option("SCENARIO", request->scenario, "Scenario file (TOML)");
    run->add_option("-o,--output", request->output, "Folder for the results; default runs/SCENARIO")
        ->type_name("DIR");
    run->add_option("--set", request->overrides,
                    "Change a value of the scenario, e.g. laser.power=200 W; repeatable")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all();
    auto* until =
        run->add_option("--until", request->until, "Run up to this simulated time, e.g. \"0.5 ms\"");
    until->type_name("TIME");
    run->add_option("--steps", request->steps, "Run so many steps")
        ->type_name("N")
        ->check(CLI::PositiveNumber)
        ->excludes(until);
    run->add_option("--threads", request->threads, "Threads of the solver; default all cores")
        ->type_name("N")
        ->check(CLI::Range(1, 4096));
    run->add_option(
           "--restart", request->restart,
           "Go on from this checkpoint, in its run folder unless --output names another; the scenario in the "
           "checkpoint holds, changed by SCENARIO and --set if given")
        ->type_name("CHECKPOINT");
    run->add_flag("--repl", request->steering.prompt,
                  "Steer the run at a prompt, or by commands from a pipe; it waits for `run`");
    run->add_option("--script", request->steering.script,
                    "Carry out the commands of this file first, then go on to the end")
        ->type_name("FILE");
    run->add_option("--replay", request->steering.replay,
                    "Do again what a journal.txt says: ends in the same state bit for bit")
        ->type_name("JOURNAL");
    run->add_flag("--no-render", request->no_render, "No pictures, no movie; data files as ever");
    run->add_option("--render-backend", request->backend, "auto, x11, xvfb, egl, osmesa or none")
        ->type_name("NAME");
    run->add_option("--wall-limit", request->wall_limit,
                    "Stop with a checkpoint in time to end within so long")
        ->type_name("HH:MM:SS");
    run->add_flag("--overwrite", request->overwrite, "Replace the run that the folder holds");
    auto* quiet = run->add_flag("-q,--quiet", request->quiet, "Warnings and errors only");
    run->add_flag("-v,--verbose", request->verbose, "Show all that goes into log.txt")->excludes(quiet);
    run->footer(
        "SIGINT (Ctrl-C), SIGTERM and SIGHUP stop at the next step with a checkpoint (exit code 3), SIGUSR1\n"
        "makes a checkpoint and goes on.\n"
        "Examples:\n"
        "  meltscope run scenarios/quick_look.toml\n"
        "  meltscope run scenarios/quick_look.toml --set \"laser.power=200 W\" --set \"checkpoint.every=0.1 "
        "ms\" "
        "-o runs/hot\n"
        "  meltscope run --restart runs/hot/checkpoints/step_000000500.h5");
    run->callback([request, &chosen] { chosen = [request] { return execute(*request); }; });
}

} // namespace meltscope
