#pragma once

#include "viz/data_sets.hpp"

#include <filesystem>

namespace meltscope::viz {

/// An instant from a saved free surface, for views_of_surfaces(). `head` has all but the fields; its lattice
/// says where the domain lies. Throws VizError, naming the file and what it lacks.
Instant read_surface_file(const std::filesystem::path& vtp, const Snapshot& head);

} // namespace meltscope::viz
