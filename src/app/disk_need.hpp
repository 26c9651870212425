#pragma once

#include "run_setup.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace meltscope {

/// What a run will put on the disk, bytes; estimated before it, as if nothing were compressed.
struct DiskNeed {
    std::int64_t outputs = 0;
    double files = 0.0;
    double pictures = 0.0;
    double checkpoints = 0.0; ///< as many as are kept, and one more while it is written

    double sum() const { return files + pictures + checkpoints; }
};

/// A checkpoint's size.
double checkpoint_bytes(const Simulation& simulation);

DiskNeed disk_need(const PreparedRun& prepared, bool draws);

/// Bytes that are free where a folder is or will be; negative if the system does not say.
double free_disk(const std::filesystem::path& folder);

/// In one line for people.
std::string in_words(const DiskNeed& need);

} // namespace meltscope
