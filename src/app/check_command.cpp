#include "commands.hpp"
#include "disk_need.hpp"
#include "exit_codes.hpp"
#include "machine.hpp"
#include "run_setup.hpp"
#include "stopwatch.hpp"
#include "text.hpp"

#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/scenario/setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

namespace meltscope {
namespace {

struct CheckRequest {
    std::filesystem::path scenario;
    std::vector<std::string> overrides;
};

void print(const std::string& line) {
    print_result(line + "\n");
}

/// The step size in s once something has melted and is twice as hot as its liquidus.
double melting_step(Simulation& simulation) {
    const double hottest_at_start = simulation.peak_temperature;
    for (const EquationOfState& eos : simulation.eos)
        simulation.peak_temperature = std::max(simulation.peak_temperature, 2.0 * eos.liquidus);
    StepLimit limit;
    const double dt = largest_step(simulation, limit);
    simulation.peak_temperature = hottest_at_start;
    return dt;
}

/// Wall seconds of a step: the median of a few.
double seconds_per_step(Simulation& simulation) {
    std::vector<double> seconds;
    while (seconds.size() < 5 && simulation.time < simulation.parameters.time.end) {
        const Stopwatch watch;
        advance(simulation, simulation.parameters.time.end);
        seconds.push_back(watch.seconds());
    }
    return median(seconds);
}

/// Lays the layers of powder, which would come in the course of the run: whether they can be packed and fit
/// shows only then.
void lay_layers(PreparedRun& prepared) {
    Run& run = prepared.run;
    const CommandSource layers = scheduled_layers(prepared.scenario.layers);
    for (double time = layers.next_time(run); time != never; time = layers.next_time(run)) {
        const std::int64_t before = run.simulation.particles.count();
        run.simulation.time = time;
        layers.apply(run);
        print(fmt::format("# layer      at t = {}: {} particles", in_si(time, "s"),
                          run.simulation.particles.count() - before));
    }
}

int execute(const CheckRequest& request) {
    InputOfRun input = read_input(request.scenario, {}, request.overrides);
    const std::string resolved = to_toml(input.scenario);
    const double bytes = estimate(input.scenario).bytes;
    PreparedRun prepared = prepare_run(std::move(input));
    Simulation& simulation = prepared.run.simulation;
    const std::string disk = in_words(disk_need(prepared, true));

    print(resolved);
    const double end = simulation.parameters.time.end;
    const double dt = melting_step(simulation);
    const double steps = std::ceil(end / dt);
    const double step_seconds = seconds_per_step(simulation);
    print(fmt::format("# particles  {}", simulation.particles.count()));
    print(fmt::format("# nodes      {}", simulation.grid.node_count()));
    print(fmt::format("# memory     {:.2f} GB, of {:.2f} GB there are", std::max(bytes, peak_memory()) * 1e-9,
                      physical_memory() * 1e-9));
    print(fmt::format("# dt         {}, with molten material", in_si(dt, "s")));
    print("# disk       " + disk);
    print(fmt::format("# steps      about {:.0f} to t = {}", steps, in_si(end, "s")));
    print(fmt::format(
        "# time       about {} at {:.1f} M particle-steps/s as measured just now, outputs and pictures "
        "not counted",
        clock_time(steps * step_seconds), 1e-6 * double(simulation.particles.count()) / step_seconds));
    lay_layers(prepared);
    for (const std::string& note : scenario_notes(prepared.scenario))
        print("# note       " + note);
    return exit_code::done;
}

} // namespace

void add_check(CLI::App& program, Action& chosen) {
    auto request = std::make_shared<CheckRequest>();
    CLI::App* check = program.add_subcommand(
        "check", "Read and validate a scenario; print it with every default, and what its run will need");
    check->add_option("SCENARIO", request->scenario, "Scenario file (TOML)")->required();
    check->add_option("--set", request->overrides, "Change a value of the scenario; repeatable")
        ->type_name("KEY=VALUE")
        ->expected(1)
        ->take_all();
    check->footer("What is printed is a scenario that can be run as it is.\n"
                  "Example:\n  meltscope check scenarios/quick_look.toml --set \"domain.cell_size=10 um\"");
    check->callback([request, &chosen] { chosen = [request] { return execute(*request); }; });
}

} // namespace meltscope
