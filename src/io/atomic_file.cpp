#include "meltscope/io/atomic_file.hpp"

#include "posix_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <unistd.h>
#include <utility>

namespace meltscope {

namespace {

constexpr std::string_view temporary_suffix = ".tmp";

std::filesystem::path folder_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

} // namespace

AtomicFile::AtomicFile(std::filesystem::path path) : path_(std::move(path)) {
    temporary_ =
        folder_of(path_) / fmt::format(".{}.{}{}", path_.filename().string(), ::getpid(), temporary_suffix);
    descriptor_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor_ < 0)
        throw_file_error("cannot create", path_, errno);
}

AtomicFile::~AtomicFile() {
    if (descriptor_ < 0)
        return;
    ::close(descriptor_);
    ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
    write_all(descriptor_, bytes, path_);
}

void AtomicFile::commit() {
    if (::fsync(descriptor_) != 0)
        throw_file_error("cannot write", path_, errno);
    if (::rename(temporary_.c_str(), path_.c_str()) != 0)
        throw_file_error("cannot write", path_, errno);
    ::close(std::exchange(descriptor_, -1));
    sync_folder(folder_of(path_));
}

void write_file_atomically(const std::filesystem::path& path, std::string_view contents) {
    AtomicFile file(path);
    file.write(contents);
    file.commit();
}

std::string_view final_name_of_temporary(std::string_view name) {
    if (!name.starts_with('.') || !name.ends_with(temporary_suffix))
        return {};
    name.remove_prefix(1);
    name.remove_suffix(temporary_suffix.size());
    const auto dot = name.rfind('.');
    if (dot == std::string_view::npos || dot == 0 || dot + 1 == name.size())
        return {};
    const auto process = name.substr(dot + 1);
    const bool is_number =
        std::all_of(process.begin(), process.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    return is_number ? name.substr(0, dot) : std::string_view{};
}

} // namespace meltscope
