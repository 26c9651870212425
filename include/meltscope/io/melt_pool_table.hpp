#pragma once

#include "meltscope/run/snapshot.hpp"

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace meltscope {

/// A table that cannot be gone on with; the message names file and line.
struct TableError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A CSV file that grows by rows, each on its way to the disk when append() returns.
class RowFile {
  public:
    /// Starts the file anew with the header (one line), or, with `resume_at` (s), goes on with the one there:
    /// its rows whose first cell, the time, is at or after that and a last row that was cut off are dropped.
    /// Without a file there, resuming starts one. Throws TableError for other columns or a line that cannot
    /// be read, std::system_error for files.
    RowFile(std::filesystem::path path, const std::string& header, std::optional<double> resume_at);
    ~RowFile();
    RowFile(const RowFile&) = delete;
    RowFile& operator=(const RowFile&) = delete;

    /// Appends whole lines; to a new file with the header if somebody has removed it. Those that do not fit
    /// on the disk are taken back before std::system_error is thrown.
    void append(const std::string& lines);

  private:
    void open();

    std::filesystem::path path_;
    std::string header_;
    int file_ = -1;
};

/// The header of melt_pool.csv for these isotherms (K) and lasers: the first of each has plain names, the
/// further ones a suffix such as `_1563K` or `_right`; a further laser's columns come last. Throws
/// std::invalid_argument if there is no isotherm or one twice.
std::string melt_pool_header(const std::vector<double>& isotherms, const std::vector<std::string>& lasers);

/// melt_pool.csv: one row a snapshot with each laser's place, power, speed and the pool it makes. Numbers are
/// written so that they read back bit for bit; `nan` stands for the laser of a run without lasers.
class MeltPoolTable {
  public:
    /// See RowFile and melt_pool_header.
    MeltPoolTable(std::filesystem::path path, std::vector<double> isotherms, std::vector<std::string> lasers,
                  std::optional<double> resume_at = std::nullopt);

    /// Writes a row. snapshot.pools are those of the isotherms, in their order, and snapshot.beams the
    /// lasers', or std::invalid_argument.
    void append(const Snapshot& snapshot);

  private:
    std::vector<double> isotherms_;
    std::vector<std::string> lasers_;
    RowFile file_;
};

/// melt_pools.csv: one row for each separate pool of a snapshot and isotherm, the largest first, with the
/// lasers that make it (`left+right`; empty: none), its centre, its size and its hottest point.
class SeparatePoolsTable {
  public:
    /// See RowFile.
    explicit SeparatePoolsTable(std::filesystem::path path, std::optional<double> resume_at = std::nullopt);
    void append(const Snapshot& snapshot);

  private:
    RowFile file_;
};

} // namespace meltscope
