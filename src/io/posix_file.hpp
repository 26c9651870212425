#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace meltscope {

/// An open file descriptor that closes itself.
class FileDescriptor {
  public:
    explicit FileDescriptor(int descriptor = -1) : descriptor_(descriptor) {}
    FileDescriptor(FileDescriptor&& other) noexcept : descriptor_(other.release()) {}
    FileDescriptor& operator=(FileDescriptor&& other) noexcept;
    ~FileDescriptor() { reset(); }

    int get() const { return descriptor_; }
    bool is_open() const { return descriptor_ >= 0; }
    void reset();

    /// Hands the descriptor to the caller, who then closes it.
    int release() { return std::exchange(descriptor_, -1); }

  private:
    int descriptor_;
};

/// Throws std::system_error "WHAT PATH: reason" for the errno given, with a hint where one helps.
[[noreturn]] void throw_file_error(std::string_view what, const std::filesystem::path& path,
                                   int error_number);

/// open(2) with O_CLOEXEC; throws by throw_file_error.
FileDescriptor open_file(const std::filesystem::path& path, int flags, std::string_view what);

/// Writes all bytes, whatever write(2) takes at a time; throws by throw_file_error.
void write_all(int descriptor, std::string_view bytes, const std::filesystem::path& path);

/// fsync of a folder, so that names made or changed in it last.
void sync_folder(const std::filesystem::path& folder);

/// The whole file as bytes; throws by throw_file_error.
std::string read_file(const std::filesystem::path& path);

} // namespace meltscope
