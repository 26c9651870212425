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

/// The header of melt_pool.csv for these isotherms (K): the first has plain names, the further ones a suffix
/// such as
/// `_1563K`. Throws std::invalid_argument if there is none or one twice.
std::string melt_pool_header(const std::vector<double>& isotherms);

/// melt_pool.csv: one row a snapshot, each on its way to the disk when append() returns. Numbers are written
/// so that they read back bit for bit; `nan` stands for the laser of a run without lasers. Beam figures are
/// those of the first laser.
class MeltPoolTable {
  public:
    /// Starts the table anew, or, with `resume_at` (s), goes on with the one there: its rows at or after that
    /// time and a last row that was cut off are dropped. Without a table there, resuming starts one. Throws
    /// TableError for a table with other columns or a line that cannot be read, std::system_error for files.
    MeltPoolTable(std::filesystem::path path, std::vector<double> isotherms,
                  std::optional<double> resume_at = std::nullopt);
    ~MeltPoolTable();
    MeltPoolTable(const MeltPoolTable&) = delete;
    MeltPoolTable& operator=(const MeltPoolTable&) = delete;

    /// Writes a row. snapshot.pools are those of the isotherms, in their order, or std::invalid_argument. A
    /// row that does not fit on the disk is taken back whole before std::system_error is thrown.
    void append(const Snapshot& snapshot);

  private:
    std::filesystem::path path_;
    std::vector<double> isotherms_;
    int file_ = -1;
};

} // namespace meltscope
