#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace meltscope {

/// A run.json that is not one; the message names file and reason.
struct RunSummaryError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// What a run amounted to. The lists keep their order in the file.
struct RunSummary {
    using Figures = std::vector<std::pair<std::string, double>>;

    std::string version;
    std::string git_hash;
    std::string title;   ///< of the scenario
    std::string outcome; ///< "running", "done", "stopped", "failed"
    std::string message; ///< why it stopped or failed; empty otherwise
    int threads = 0;
    std::int64_t particles = 0;
    std::int64_t steps = 0;
    double time = 0.0;    ///< s, simulated
    Figures wall_seconds; ///< s by phase: solver, level_set, in_situ, output, total
    double particle_steps_per_second = 0.0;
    Figures ledger;    ///< J by name
    Figures rendering; ///< frames, waits, drops ...
};

/// The summary as indented JSON; a number that is not finite becomes null.
std::string to_json(const RunSummary& summary);

/// Writes run.json whole or not at all. Throws std::system_error.
void write_run_summary(const std::filesystem::path& path, const RunSummary& summary);

/// Reads run.json back; null becomes NaN. Throws RunSummaryError for what is not a summary, std::system_error
/// for files.
RunSummary read_run_summary(const std::filesystem::path& path);

} // namespace meltscope
