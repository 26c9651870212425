#include "commands.hpp"

#include "meltscope/io/hdf5_version.hpp"
#include "meltscope/lanes.hpp"
#include "meltscope/version.hpp"
#include "viz/version.hpp"

#include <fmt/format.h>

namespace meltscope {

std::string version_text() {
    return fmt::format("meltscope {} ({}), {}, SIMD width {}, VTK {}, HDF5 {}", version, git_hash, compiler,
                       lane_count, viz::vtk_version(), hdf5_version());
}

} // namespace meltscope
