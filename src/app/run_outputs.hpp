#pragma once

#include "run_setup.hpp"
#include "stopwatch.hpp"
#include "terminal.hpp"

#include "meltscope/console/console_state.hpp"
#include "meltscope/io/melt_pool_table.hpp"
#include "meltscope/io/run_folder.hpp"
#include "viz/pipeline.hpp"

#include <optional>
#include <string>
#include <vector>

namespace meltscope {

/// Everything that a run leaves in its folder: connects the sinks, keeps run.json, makes the movies at the
/// end.
class RunOutputs {
  public:
    /// The folder is there and locked. Writes run.toml and run.json. A run taken up from a checkpoint goes on
    /// with the files there; run.toml stays the scenario that it began with, from which its journal goes on.
    RunOutputs(RunPaths paths, const PreparedRun& prepared, viz::Backend backend, int threads,
               Terminal& terminal);

    /// Sinks for pictures and files, the melt-pool table and checkpoints.
    std::vector<Sink> sinks();

    /// Appends to the melt-pool tables after a step, if the scenario asks for a row a step.
    void after_step(const Run& run);

    /// The pool's size at the last output, for the progress line; empty if nothing is molten.
    const std::string& pool() const { return pool_; }

    bool draws() const { return draws_; }

    /// What pictures show from the next one on. Throws viz::VizError for what they cannot show.
    void set_render(const RenderSettings& settings);

    /// Makes one picture now, outside the run's numbering. Throws viz::VizError.
    void write_picture(const Run& run, const std::string& view, const std::filesystem::path& png);

    /// The scenario was changed while the run is under way: checkpoints hold the new one. Files keep their
    /// form.
    void scenario_changed();

    /// The run was put back to an earlier state: what lies at or after its time is dropped.
    void restored(const Run& run);

    /// Writes the state that the run failed in; its file.
    std::filesystem::path keep_for_inspection(const Run& run) const;

    /// About how long it takes to stop now, s: a checkpoint, pictures and files that are under way, tables.
    double seconds_to_stop(const Run& run) const;

    enum class Movies { make, leave };
    /// Waits for the pictures, makes the movies and writes run.json for the last time. `message` says why the
    /// run stopped or failed.
    void finish(const Run& run, const std::string& outcome, const std::string& message,
                Movies movies = Movies::make);

    /// One line a kind of file: what it is and where.
    std::vector<std::string> list() const;

  private:
    void write_summary(const Run& run, const std::string& outcome, const std::string& message) const;
    void write_checkpoint_of(const Run& run);
    void add_row(const Snapshot& snapshot);
    void require_folder();
    void open_files(const Run& run, std::optional<double> resume_at);
    void make_movies();

    RunPaths paths_;
    const Scenario& scenario_;
    std::string scenario_text_;
    bool draws_;
    int threads_;
    Terminal& terminal_;
    viz::Backend backend_;
    // Always there; made anew when the run is put back.
    std::optional<MeltPoolTable> table_;
    std::optional<SeparatePoolsTable> pools_table_;
    std::optional<viz::Pipeline> pipeline_;
    double table_time_ = -1.0; ///< s, of the last row
    std::string pool_;
    std::int64_t steps_at_start_;
    std::optional<std::filesystem::path> last_checkpoint_;
    double longest_checkpoint_ = 0.0; ///< s, to write it
    Stopwatch since_start_;
};

/// The pictures that a scenario asks for, into that folder.
viz::RenderOptions render_options(const std::filesystem::path& folder, const RenderSpec& render);

/// The data files that a scenario asks for.
viz::FileOptions file_options(const std::filesystem::path& folder, const OutputSpec& output);

/// How many pictures of a view a run folder holds.
std::int64_t count_pictures(const RunPaths& paths, const std::string& view);

/// Pictures a second for a movie of so many pictures: it lasts about six seconds if that takes 5 to 25 a
/// second.
double movie_rate(std::int64_t pictures);

/// Length x width x depth of the pool at the first isotherm; empty if there is none.
std::string pool_size(const Snapshot& snapshot);

} // namespace meltscope
