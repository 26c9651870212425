#include "checkpoint_seal.hpp"

#include "meltscope/io/checkpoint.hpp"
#include "posix_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace meltscope {

namespace {

constexpr std::string_view magic = "meltscope checkpoint\nschema ";

std::size_t read_block(int descriptor, char* block, std::size_t size, std::size_t offset,
                       const std::filesystem::path& path) {
    std::size_t filled = 0;
    while (filled < size) {
        const ssize_t count =
            ::pread(descriptor, block + filled, size - filled, static_cast<off_t>(offset + filled));
        if (count == 0)
            break;
        if (count > 0)
            filled += static_cast<std::size_t>(count);
        else if (errno != EINTR)
            throw_file_error("cannot read", path, errno);
    }
    return filled;
}

/// After FNV-1a (Fowler, Noll, Vo), eight bytes at a time; the shift carries high bits down, without which
/// two flipped top bits would cancel. Each word's step is a bijection of the state, so no single altered word
/// goes unseen.
std::uint64_t hash_words(std::uint64_t state, const char* bytes, std::size_t size) {
    for (std::size_t at = 0; at < size; at += 8) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes + at, std::min<std::size_t>(8, size - at));
        state = (state ^ word) * 0x100000001b3u;
        state ^= state >> 32;
    }
    return state;
}

std::uint64_t hash_after_seal(int descriptor, const std::filesystem::path& path) {
    std::uint64_t state = 0xcbf29ce484222325u;
    std::vector<char> block(1 << 16);
    for (std::size_t offset = seal_size;;) {
        const std::size_t count = read_block(descriptor, block.data(), block.size(), offset, path);
        state = hash_words(state, block.data(), count);
        offset += count;
        if (count < block.size())
            return state;
    }
}

std::size_t length_of(int descriptor, const std::filesystem::path& path) {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0)
        throw_file_error("cannot read", path, errno);
    if (!S_ISREG(status.st_mode))
        throw CheckpointError(fmt::format("{} is not a file", path.string()));
    return static_cast<std::size_t>(status.st_size);
}

std::string make_seal(std::size_t length, std::uint64_t hash) {
    auto seal = fmt::format("{}{}\nbytes {}\nhash {:016x}\n", magic, checkpoint_schema_version, length, hash);
    seal.resize(seal_size, '\0');
    return seal;
}

/// The schema that a seal names. Throws CheckpointError if it names none or not this one.
void check_schema(std::string_view seal, const std::filesystem::path& path) {
    if (!seal.starts_with(magic))
        throw CheckpointError(fmt::format("{} is not a meltscope checkpoint", path.string()));
    seal.remove_prefix(magic.size());
    int schema = 0;
    const auto [end, error] = std::from_chars(seal.data(), seal.data() + seal.size(), schema);
    if (error != std::errc{} || end == seal.data() + seal.size() || *end != '\n')
        throw CheckpointError(fmt::format("{} is damaged: its first lines cannot be read", path.string()));
    if (schema != checkpoint_schema_version)
        throw CheckpointError(
            fmt::format("{} has checkpoint schema {}, this meltscope reads schema {}: use the {} "
                        "version that wrote it",
                        path.string(), schema, checkpoint_schema_version,
                        schema > checkpoint_schema_version ? "newer" : "older"));
}

/// The number of bytes that a seal names, or -1.
std::int64_t sealed_length(std::string_view seal) {
    constexpr std::string_view key = "\nbytes ";
    const auto at = seal.find(key);
    std::int64_t length = -1;
    if (at != std::string_view::npos)
        std::from_chars(seal.data() + at + key.size(), seal.data() + seal.size(), length);
    return length;
}

} // namespace

void seal_checkpoint(const std::filesystem::path& path) {
    const auto file = open_file(path, O_RDWR, "cannot write");
    const auto length = length_of(file.get(), path);
    write_all(file.get(), make_seal(length, hash_after_seal(file.get(), path)), path);
}

std::size_t verify_seal(const std::filesystem::path& path) {
    // O_NONBLOCK: a pipe under this name must be refused, not waited for.
    const auto file = open_file(path, O_RDONLY | O_NONBLOCK, "cannot read checkpoint");
    const auto length = length_of(file.get(), path);
    std::string seal(seal_size, '\0');
    seal.resize(read_block(file.get(), seal.data(), seal.size(), 0, path));
    check_schema(seal, path);
    const auto expected = sealed_length(seal);
    if (expected >= 0 && static_cast<std::uint64_t>(expected) != length)
        throw CheckpointError(fmt::format("{} is damaged: it has {} bytes and was written with {}",
                                          path.string(), length, expected));
    if (seal != make_seal(length, hash_after_seal(file.get(), path)))
        throw CheckpointError(fmt::format(
            "{} is damaged: its contents are not what was written (hash differs); use an older checkpoint",
            path.string()));
    return length;
}

} // namespace meltscope
