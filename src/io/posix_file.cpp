#include "posix_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>

namespace meltscope {

namespace {

std::string_view hint_for(int error_number) {
    switch (error_number) {
    case ENOSPC:
    case EDQUOT:
        return "; free some space there or choose another --output";
    case EROFS:
    case EACCES:
    case EPERM:
        return "; choose a folder that can be written to";
    default:
        return "";
    }
}

} // namespace

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
    if (this != &other) {
        reset();
        descriptor_ = other.release();
    }
    return *this;
}

void FileDescriptor::reset() {
    if (descriptor_ >= 0)
        ::close(descriptor_);
    descriptor_ = -1;
}

void throw_file_error(std::string_view what, const std::filesystem::path& path, int error_number) {
    throw std::system_error(error_number, std::generic_category(),
                            fmt::format("{} {}{}", what, path.string(), hint_for(error_number)));
}

FileDescriptor open_file(const std::filesystem::path& path, int flags, std::string_view what) {
    FileDescriptor file(::open(path.c_str(), flags | O_CLOEXEC, 0666));
    if (!file.is_open())
        throw_file_error(what, path, errno);
    return file;
}

void write_all(int descriptor, std::string_view bytes, const std::filesystem::path& path) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno != EINTR)
            throw_file_error("cannot write", path, errno);
        if (written > 0)
            bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

void sync_folder(const std::filesystem::path& folder) {
    const auto handle = open_file(folder, O_RDONLY | O_DIRECTORY, "cannot open folder");
    // Some file systems cannot sync a folder and say EINVAL: then there is nothing more to be done.
    if (::fsync(handle.get()) != 0 && errno != EINVAL)
        throw_file_error("cannot sync folder", folder, errno);
}

std::string read_file(const std::filesystem::path& path) {
    const auto file = open_file(path, O_RDONLY, "cannot read");
    std::string contents;
    char block[1 << 16];
    for (;;) {
        const ssize_t count = ::read(file.get(), block, sizeof block);
        if (count == 0)
            return contents;
        if (count > 0)
            contents.append(block, static_cast<std::size_t>(count));
        else if (errno != EINTR)
            throw_file_error("cannot read", path, errno);
    }
}

} // namespace meltscope
