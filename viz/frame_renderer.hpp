#pragma once

#include "viz/options.hpp"
#include "viz/picture.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

namespace meltscope::viz {

/// Owns the display and the one render window of a run; all members belong to one thread.
class FrameRenderer {
  public:
    /// Opens the display and a window on it. Throws VizError when there is none to be had.
    explicit FrameRenderer(Backend backend);
    ~FrameRenderer();
    FrameRenderer(const FrameRenderer&) = delete;
    FrameRenderer& operator=(const FrameRenderer&) = delete;

    /// The picture of one view (RGB, 8 bit). Throws VizError.
    vtkSmartPointer<vtkImageData> render(const Instant& instant, const std::vector<HistoryPoint>& history,
                                         const RenderOptions& options, const std::string& view);

    Backend backend() const;
    std::string window_class() const;
    std::string renderer_name() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Writes a PNG under a temporary name, then renames it; the time is kept in the text entry `time_s`. Throws
/// VizError.
void write_png(vtkImageData* image, const std::filesystem::path& path, double time);
/// The text entry `time_s` of a PNG, s; nothing if it has none.
std::optional<double> png_time(const std::filesystem::path& path);

} // namespace meltscope::viz
