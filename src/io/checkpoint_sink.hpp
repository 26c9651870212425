#pragma once

#include "hdf5_support.hpp"

#include <optional>

namespace meltscope {

/// Where HDF5 puts a checkpoint: an open file, and the first thing that went wrong with it.
///
/// HDF5 1.10 does not survive a write that fails: open files stay half closed and the process crashes when it
/// ends. So it is not told. The sink keeps errno, drops what follows, and whoever writes asks it.
struct CheckpointSink {
    int descriptor = -1;
    haddr_t allocated = 0; ///< bytes that HDF5 has laid out
    haddr_t length = 0;    ///< bytes that the file has
    int error_number = 0;  ///< errno of the first failure; zero while all is well
    /// Of HDF5, which reads the driver once more after the file, when it closes, has let go of it.
    std::optional<Hdf5Handle> driver = std::nullopt;
};

/// File access properties under which H5Fcreate writes into `sink`, whatever name it is given. `sink`
/// outlives the file. An identifier below zero tells that HDF5 refused.
Hdf5Handle make_sink_access(CheckpointSink& sink);

} // namespace meltscope
