#pragma once

#include <cstddef>
#include <filesystem>

namespace meltscope {

/// Bytes at the start of a checkpoint that HDF5 leaves to its user; a power of two from 512.
inline constexpr std::size_t seal_size = 512;

/// Writes the seal (schema, length and hash of all that follows it) into the first seal_size bytes of a
/// finished file. HDF5 parses damaged metadata without much caution, so damage has to be found before HDF5 is
/// asked.
void seal_checkpoint(const std::filesystem::path& path);

/// Throws CheckpointError unless the file carries a seal of this schema and is what was sealed.
/// \return the file's length in bytes, an upper bound for what its arrays can hold
std::size_t verify_seal(const std::filesystem::path& path);

} // namespace meltscope
