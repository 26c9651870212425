#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace meltscope {

/// A run folder that must not be used as asked; the message says why and what to do.
struct RunFolderError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Where the outputs of a run lie. Plain paths: nothing is created or looked up.
struct RunPaths {
    std::filesystem::path root;

    std::filesystem::path scenario() const { return root / "run.toml"; }
    std::filesystem::path summary() const { return root / "run.json"; }
    std::filesystem::path journal() const { return root / "journal.txt"; }
    std::filesystem::path log() const { return root / "log.txt"; }
    std::filesystem::path melt_pool_table() const { return root / "melt_pool.csv"; }
    std::filesystem::path separate_pools_table() const { return root / "melt_pools.csv"; }
    std::filesystem::path solidification_table() const { return root / "solidification.csv"; }
    std::filesystem::path solidification_points() const { return root / "solidification.vtp"; }
    std::filesystem::path report() const { return root / "report.html"; }
    std::filesystem::path lock() const { return root / "run.lock"; }
    std::filesystem::path console_socket() const { return root / "console.sock"; }
    /// Index of a file series over time: "particles", "surface", "pool" or "grid".
    std::filesystem::path collection(std::string_view series) const;
    /// Folder of such a series' files.
    std::filesystem::path series_folder(std::string_view series) const { return root / series; }
    std::filesystem::path frames() const { return root / "frames"; }
    /// Picture number `index` of a view, frames/VIEW_000012.png.
    std::filesystem::path frame(std::string_view view, std::int64_t index) const;
    std::filesystem::path movie(std::string_view view) const;
    std::filesystem::path plots() const { return root / "plots"; }
    std::filesystem::path checkpoints() const { return root / "checkpoints"; }
    /// checkpoints/step_000000500.h5
    std::filesystem::path checkpoint(std::int64_t step) const;
    /// inspect_step_000000500.h5: the state that a failed run ended in. Not among the checkpoints, so that no
    /// restart takes it by itself.
    std::filesystem::path inspection(std::int64_t step) const;
};

/// A checkpoint by its name in the run folder.
struct CheckpointFile {
    std::int64_t step = 0;
    std::filesystem::path path;
};

/// The checkpoints of a run, oldest step first; empty if there are none.
std::vector<CheckpointFile> list_checkpoints(const RunPaths& paths);

/// Removes all but the `keep` checkpoints of the latest steps. `keep` is at least 1, or
/// std::invalid_argument.
void prune_checkpoints(const RunPaths& paths, int keep);

/// Removes the checkpoints of steps after `step`: a run restarted there will make them anew.
void drop_checkpoints_after(const RunPaths& paths, std::int64_t step);

/// True if meltscope writes files of that name; `relative` is relative to the run folder.
bool is_run_output(const std::filesystem::path& relative);

/// What to do about a folder that holds something already.
enum class ExistingRun {
    refuse,    ///< throw RunFolderError
    overwrite, ///< remove what meltscope writes, and nothing else
    resume     ///< keep all: a restart goes on there
};

/// A run's claim on its folder: while the object lives, no other run can have the folder.
class RunFolder {
  public:
    /// Creates the folder and its parents if need be, locks it, and then does with the contents as told.
    /// Throws RunFolderError if the folder is taken or holds something, std::system_error for what the system
    /// reports.
    RunFolder(const std::filesystem::path& root, ExistingRun existing);
    ~RunFolder();
    RunFolder(const RunFolder&) = delete;
    RunFolder& operator=(const RunFolder&) = delete;

    const RunPaths& paths() const { return paths_; }

    /// The process whose lock was found although it no longer runs: that run ended without cleaning up.
    std::optional<long> stale_owner() const { return stale_owner_; }

  private:
    void take_lock();

    RunPaths paths_;
    std::optional<long> stale_owner_;
    int lock_ = -1;
};

} // namespace meltscope
