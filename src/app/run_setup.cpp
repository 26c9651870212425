#include "run_setup.hpp"

#include "exit_codes.hpp"
#include "machine.hpp"

#include "meltscope/console/commands.hpp"
#include "meltscope/io/run_state.hpp"
#include "meltscope/scenario/scenario_file.hpp"
#include "meltscope/scenario/setup.hpp"

#include <fmt/format.h>

#include <system_error>

namespace meltscope {
namespace {

ParticleSelection particle_selection(OutputSpec::Particles particles) {
    switch (particles) {
    case OutputSpec::Particles::surface:
        return ParticleSelection::surface;
    case OutputSpec::Particles::melt:
        return ParticleSelection::melt;
    case OutputSpec::Particles::all:
        return ParticleSelection::all;
    case OutputSpec::Particles::none:
        break;
    }
    return ParticleSelection::none;
}

void require_same_grid(const Scenario& a, const Scenario& b, const std::filesystem::path& checkpoint) {
    const bool same = a.domain.min == b.domain.min && a.domain.cell_size == b.domain.cell_size &&
                      (a.domain.cells() == b.domain.cells()).all() &&
                      a.domain.particles_per_cell == b.domain.particles_per_cell;
    if (!same)
        throw UsageError(
            fmt::format("{} was made with another [domain]: a run goes on with the domain it began with",
                        checkpoint.string()));
    if (a.materials.size() != b.materials.size())
        throw UsageError(fmt::format("{} was made with {} material(s), the scenario has {}",
                                     checkpoint.string(), a.materials.size(), b.materials.size()));
}

/// A checkpoint that the user has named: that it cannot be read is bad input, not a failed run.
CheckpointData read_given_checkpoint(const std::filesystem::path& path) {
    try {
        return read_checkpoint(path);
    } catch (const CheckpointError& error) {
        throw UsageError(error.what());
    } catch (const std::system_error& error) {
        throw UsageError(error.what());
    }
}

Steering steering_of(const Scenario& scenario) {
    return steering_of(run_parameters(scenario), output_schedule(scenario));
}

} // namespace

OutputSchedule output_schedule(const Scenario& scenario) {
    OutputSchedule schedule;
    schedule.output = {scenario.output.every, scenario.output.every_steps};
    if (scenario.render.every)
        schedule.picture = Cadence{scenario.render.every, std::nullopt};
    schedule.checkpoint.every = scenario.checkpoint.every;
    schedule.particles = particle_selection(scenario.output.particles);
    return schedule;
}

void require_memory_for(const Scenario& scenario) {
    const Estimate need = estimate(scenario);
    const double there = physical_memory();
    if (need.bytes > there)
        throw UsageError(
            fmt::format("the scenario needs about {:.1f} GB of memory for {} nodes and up to {} particles, "
                        "and this machine has {:.1f} GB: take a larger domain.cell_size, a smaller domain "
                        "or fewer domain.particles_per_cell",
                        need.bytes * 1e-9, need.nodes, need.particles_at_most, there * 1e-9));
}

InputOfRun read_input(const std::optional<std::filesystem::path>& scenario_file,
                      const std::filesystem::path& checkpoint, const std::vector<std::string>& overrides) {
    InputOfRun input;
    if (checkpoint.empty()) {
        input.scenario = read_scenario(scenario_file.value(), overrides);
    } else {
        input.checkpoint = read_given_checkpoint(checkpoint);
        const std::string name = checkpoint.string() + ":/scenario";
        input.original = read_scenario_text(input.checkpoint->scenario, {}, name);
        input.scenario = scenario_file ? read_scenario(*scenario_file, overrides)
                                       : read_scenario_text(input.checkpoint->scenario, overrides, name);
        require_same_grid(*input.original, input.scenario, checkpoint);
        if (to_toml(*input.original) != to_toml(input.scenario))
            input.adopted = adoption(overrides, scenario_file.value_or(std::filesystem::path()),
                                     to_toml(*input.original));
    }
    require_memory_for(input.scenario);
    return input;
}

PreparedRun prepare_run(InputOfRun input) {
    PreparedRun prepared;
    prepared.scenario = std::move(input.scenario);
    prepared.adopted = std::move(input.adopted);
    RunParameters parameters = run_parameters(prepared.scenario);
    prepared.run.schedule = output_schedule(prepared.scenario);
    const Grid grid = scenario_grid(prepared.scenario);
    const int lattice = lattice_of(prepared.scenario);
    if (!input.checkpoint) {
        prepared.run.simulation =
            make_simulation(std::move(parameters), grid, fill_scenario(prepared.scenario), lattice);
        require_room_for_layers(prepared.run.simulation, prepared.scenario.layers, 0);
        if (prepared.scenario.output.solidification)
            prepared.run.solidification = begin_solidification(prepared.run.simulation);
        return prepared;
    }
    const CheckpointData& data = *input.checkpoint;
    const Steering steering = with_changes(read_steering(data.steering), steering_of(*input.original),
                                           steering_of(prepared.scenario));
    apply_steering(steering, parameters, prepared.run.schedule);
    prepared.run.simulation = simulation_from(data, std::move(parameters), grid, lattice);
    prepared.run.layers_laid = layers_laid_by(data);
    require_room_for_layers(prepared.run.simulation, prepared.scenario.layers, prepared.run.layers_laid);
    if (prepared.scenario.output.solidification)
        prepared.run.solidification = solidification_from(data, prepared.run.simulation);
    prepared.run.journal = data.journal;
    prepared.resumed_at = data.time;
    return prepared;
}

void adopt_changes(PreparedRun& prepared, const std::vector<std::string>& changes) {
    const std::string text = to_toml(prepared.scenario);
    InputOfRun input;
    input.original = prepared.scenario;
    input.scenario = read_scenario_text(text, changes, "the run's scenario");
    require_same_grid(*input.original, input.scenario, "the run");
    Scenario of_same_layers = input.scenario;
    of_same_layers.layers = prepared.scenario.layers;
    if (to_toml(of_same_layers) != to_toml(input.scenario))
        throw UsageError("the scenario's powder layers cannot be changed in a run; `layer` adds one");
    Run& run = prepared.run;
    balance(run.simulation);
    input.checkpoint = checkpoint_of(run, text);
    const std::vector<double> isotherms = run.simulation.parameters.isotherms;
    PreparedRun changed = prepare_run(std::move(input));
    changed.run.simulation.parameters.isotherms = isotherms; // the table has its columns
    prepared.scenario = std::move(changed.scenario);
    run.simulation = std::move(changed.run.simulation);
    run.schedule = changed.run.schedule;
    run.solidification = std::move(changed.run.solidification);
}

std::optional<std::filesystem::path> folder_of_checkpoint(const std::filesystem::path& checkpoint) {
    const auto folder = std::filesystem::absolute(checkpoint).lexically_normal().parent_path();
    if (folder.filename() != "checkpoints")
        return std::nullopt;
    return folder.parent_path();
}

} // namespace meltscope
