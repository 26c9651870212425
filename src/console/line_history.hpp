#pragma once

#include <histedit.h>

#include <filesystem>
#include <string>

namespace meltscope {

/// The lines typed so far, in this session and, if there is a file, in earlier ones.
class LineHistory {
  public:
    /// Reads the file, and makes its folder; empty: the history ends with the session.
    explicit LineHistory(std::filesystem::path file);
    ~LineHistory();
    LineHistory(const LineHistory&) = delete;
    LineHistory& operator=(const LineHistory&) = delete;

    void add(const std::string& line);
    History* get() const { return history_; }

  private:
    std::filesystem::path file_;
    History* history_;
};

} // namespace meltscope
