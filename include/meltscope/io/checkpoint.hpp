#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace meltscope {

/// A checkpoint that cannot be written or must not be read; the message names the file and the reason.
struct CheckpointError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The layout of checkpoint files that this version writes and reads.
inline constexpr int checkpoint_schema_version = 1;

/// The particles of a checkpoint, ordered by id; n of them.
struct CheckpointParticles {
    std::vector<double> position;        ///< m, 3n, xyz xyz ...
    std::vector<double> mass;            ///< kg, n
    std::vector<double> volume;          ///< m^3, n
    std::vector<double> specific_energy; ///< J/kg, n
    std::vector<std::int64_t> id;        ///< n
    std::vector<std::int32_t> material;  ///< n, index into the run's materials
    /// Further arrays by name, each with a whole number of values a particle.
    std::vector<std::pair<std::string, std::vector<double>>> extra;
};

/// An array of the grid; values.size() is the product of dims.
struct CheckpointGridArray {
    std::string name;
    std::vector<std::uint64_t> dims; ///< slowest first, so z y x for a field with x fastest
    std::vector<double> values;
};

/// All that a restart needs, and nothing that it can make again.
struct CheckpointData {
    int schema_version = checkpoint_schema_version;
    double time = 0.0; ///< s
    std::int64_t step = 0;
    double dt = 0.0; ///< s, of the step that led here
    CheckpointParticles particles;
    std::vector<CheckpointGridArray> grid;
    std::string scenario;                               ///< the resolved scenario, TOML
    std::string steering;                               ///< the steerable parameters as they stand
    std::string journal;                                ///< what changed the run so far
    std::vector<std::pair<std::string, double>> ledger; ///< J, by name
};

/// Writes an HDF5 file: /particles/*, /grid/*, /scenario, /steering/{parameters,journal}, /ledger
/// (attributes), and the attributes schema_version, time, step, dt of the root. Every array is chunked with
/// Fletcher32, and the whole file is sealed with its length and a hash in the user block. It appears under
/// `path` whole or not at all; equal data make equal bytes. Throws CheckpointError for arrays whose sizes or
/// names do not fit, std::system_error for what the system reports (a full disk ...). Nothing of a checkpoint
/// that failed is left, and the former one under that name stays.
void write_checkpoint(const std::filesystem::path& path, const CheckpointData& data);

/// Reads a checkpoint back, bit for bit. Grid arrays, extra arrays and ledger entries come ordered by name.
/// The seal is verified before HDF5 sees the file, and sizes before memory is taken. Throws CheckpointError
/// for a foreign, truncated, altered or inconsistent file and for another schema; std::system_error if it
/// cannot be read.
CheckpointData read_checkpoint(const std::filesystem::path& path);

} // namespace meltscope
