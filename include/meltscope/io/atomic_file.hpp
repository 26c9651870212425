#pragma once

#include <filesystem>
#include <string_view>

namespace meltscope {

/// A file that appears under its final name whole or not at all.
///
/// It is written under a temporary name in the same folder; commit() puts it on the disk (fsync), renames it
/// and makes the new name last (fsync of the folder). Until then, and after any failure, whatever stood under
/// the final name is untouched. A temporary that was not committed is removed. Every member throws
/// std::system_error that names the path and the system's reason.
class AtomicFile {
  public:
    /// Creates the temporary `.NAME.PID.tmp` beside `path`; its folder must exist.
    explicit AtomicFile(std::filesystem::path path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// For writing by other means than write(): the temporary, open for reading and writing.
    int descriptor() const { return descriptor_; }
    const std::filesystem::path& temporary_path() const { return temporary_; }

    /// Appends to the temporary.
    void write(std::string_view bytes);

    /// Puts the file under its final name. To be called once, last.
    void commit();

  private:
    std::filesystem::path path_;
    std::filesystem::path temporary_;
    int descriptor_ = -1;
};

/// Writes `contents` to `path` by way of AtomicFile.
void write_file_atomically(const std::filesystem::path& path, std::string_view contents);

/// The final name of a temporary of AtomicFile's making; empty if `name` is not of that form.
std::string_view final_name_of_temporary(std::string_view name);

} // namespace meltscope
