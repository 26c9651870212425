#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace meltscope::viz {

/// ParaView's collection file: which file belongs to which time. On disk it is valid at every instant.
class PvdCollection {
  public:
    struct Entry {
        double time = 0.0; ///< s
        std::string file;  ///< relative to the collection
    };

    explicit PvdCollection(std::filesystem::path path) : path_(std::move(path)) {}

    /// Reads what is there (nothing if there is no file). Throws VizError if it is not a collection.
    void load();
    /// Takes out the entries at or after that time and writes the file anew.
    void drop_from(double time);
    /// Takes out the entries whose files somebody has removed: readers would fail. On disk with the next
    /// write.
    void forget_missing();
    /// Adds an entry and writes the file anew. Throws VizError if that fails.
    void append(double time, const std::string& file);

    const std::vector<Entry>& entries() const { return entries_; }

  private:
    void write() const;
    std::filesystem::path path_;
    std::vector<Entry> entries_;
};

/// Writes text to a temporary file beside `path`, brings it to the disk and renames it. Throws VizError.
void write_text_safely(const std::filesystem::path& path, const std::string& text);

} // namespace meltscope::viz
