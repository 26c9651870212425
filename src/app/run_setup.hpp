#pragma once

#include "meltscope/io/checkpoint.hpp"
#include "meltscope/run/run_loop.hpp"
#include "meltscope/scenario/scenario.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace meltscope {

/// A run that is ready to be stepped, and the scenario it follows.
struct PreparedRun {
    Scenario scenario;
    Run run;
    std::optional<double> resumed_at; ///< s, of the checkpoint that the run was taken up from
    std::string adopted; ///< for the journal: changes of the scenario under which it was taken up
};

/// When a scenario asks for outputs.
OutputSchedule output_schedule(const Scenario& scenario);

/// Throws UsageError if the scenario needs more memory than this machine has.
void require_memory_for(const Scenario& scenario);

/// What a run is made from, read and judged.
struct InputOfRun {
    Scenario scenario;
    std::optional<Scenario> original;         ///< that the checkpoint was made under
    std::optional<CheckpointData> checkpoint; ///< to go on from
    std::string adopted;                      ///< see PreparedRun
};

/// Reads what a run is made from: a scenario file, or, unless its path is empty, a checkpoint. Without a
/// scenario file the scenario is the one that the checkpoint holds. Throws UsageError if more memory is
/// needed than there is, or if the scenario has another grid than the checkpoint.
InputOfRun read_input(const std::optional<std::filesystem::path>& scenario_file,
                      const std::filesystem::path& checkpoint, const std::vector<std::string>& overrides);

/// Fills the domain, or takes the checkpoint up. What the scenario has different from the checkpoint's takes
/// effect; all else goes on as it stood, steered values included.
PreparedRun prepare_run(InputOfRun input);

/// Has a run go on under its scenario with KEY=VALUE changes, as if it had been stopped and taken up so.
/// Throws UsageError or ScenarioError, the run being as it was.
void adopt_changes(PreparedRun& prepared, const std::vector<std::string>& changes);

/// The run folder that a checkpoint lies in: DIR of DIR/checkpoints/step_000000500.h5.
std::optional<std::filesystem::path> folder_of_checkpoint(const std::filesystem::path& checkpoint);

} // namespace meltscope
