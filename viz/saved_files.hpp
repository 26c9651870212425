#pragma once

#include "viz/options.hpp"

#include "meltscope/run/snapshot.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace meltscope::viz {

/// The data files of one output that pictures can be made from; empty paths for what was not written.
struct SavedOutput {
    double time = 0.0; ///< s
    std::filesystem::path surface, grid;
};

/// The outputs that the PVD files of a run folder name and that are there, by time. Throws VizError for a PVD
/// file that cannot be read.
std::vector<SavedOutput> list_saved_outputs(const std::filesystem::path& run_dir);

/// Takes lattice and node fields of a snapshot from a grid file. Throws VizError, naming the file and what it
/// lacks.
void read_grid_file(const std::filesystem::path& vti, Snapshot& snapshot);

/// The views that the free surface alone suffices for.
const std::vector<std::string>& views_of_surfaces();

} // namespace meltscope::viz
