#pragma once

#include "meltscope/console/console_state.hpp"
#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/scenario/setup.hpp"

/// Runs for tests of what steers them.
namespace meltscope::testing {

/// A run at its start, with the outputs that its scenario asks for.
inline Run started(const Scenario& scenario) {
    Run run;
    run.simulation = make_simulation(run_parameters(scenario), scenario_grid(scenario),
                                     fill_scenario(scenario), lattice_of(scenario));
    run.schedule.output = {scenario.output.every, std::nullopt};
    return run;
}

/// What a console is lent that has neither folder nor pictures.
inline ConsoleHost host_for(const Scenario& scenario) {
    ConsoleHost host;
    host.scenario = to_toml(scenario);
    host.parameters = run_parameters(scenario);
    host.fields = {"temperature", "phi"};
    return host;
}

} // namespace meltscope::testing
