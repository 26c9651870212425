#pragma once

#include "number_table.hpp"

#include "meltscope/io/run_folder.hpp"
#include "meltscope/run/snapshot.hpp"
#include "meltscope/scenario/scenario.hpp"

namespace meltscope {

/// What a run folder tells of its instants beside the data files: the scenario and melt_pool.csv.
class SavedRun {
  public:
    /// Throws UsageError if the folder has no scenario that can be read. Without a table, lasers are where
    /// the scenario has them, and pools are unknown.
    explicit SavedRun(const RunPaths& paths);

    const Scenario& scenario() const { return scenario_; }

    /// All of a snapshot but its fields and particles. Lasers and pools are those of the table's row of that
    /// time (s); a laser that was steered off the scenario's path shows none.
    Snapshot head_at(double time) const;

  private:
    Scenario scenario_;
    NumberTable table_;
};

} // namespace meltscope
