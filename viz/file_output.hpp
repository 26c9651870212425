#pragma once

#include "viz/data_sets.hpp"
#include "viz/options.hpp"
#include "viz/pvd.hpp"

#include <map>
#include <string>

#include <vtkDataSet.h>

namespace meltscope::viz {

/// Writes the data files of a run and keeps their PVD collections.
class FileOutput {
  public:
    explicit FileOutput(FileOptions options) : options_(std::move(options)) {}

    /// Drops the entries at or after that time (s) from the collections on disk and counts on from the rest.
    void resume_at(double time);
    /// Writes what the options ask for; the number of files. Throws VizError; what was complete before stays
    /// valid.
    int write(const Instant& instant);

  private:
    void write_one(const std::string& kind, const char* extension, vtkDataSet* data, double time);
    FileOptions options_;
    int next_index_ = 0;
    std::map<std::string, PvdCollection> collections_;
};

} // namespace meltscope::viz
