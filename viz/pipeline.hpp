#pragma once

#include "viz/options.hpp"

#include "meltscope/run/snapshot.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace meltscope::viz {

/// What the pictures and files of a run have come to so far.
struct PipelineStats {
    std::int64_t frames = 0;     ///< pictures written
    std::int64_t files = 0;      ///< data files written (PVD not counted)
    std::int64_t waits = 0;      ///< times the solver waited for room in the queue
    double wait_seconds = 0.0;   ///< s, together
    std::int64_t drops = 0;      ///< snapshots whose pictures were given up because the queue was full
    double busy_seconds = 0.0;   ///< s, the viz thread's own work
    double render_seconds = 0.0; ///< s of it, pictures
    double file_seconds = 0.0;   ///< s of it, data files
    Backend backend =
        Backend::none;        ///< what the window came from; none until the first picture and without one
    std::string window_class; ///< VTK's class, e.g. vtkXOpenGLRenderWindow
    std::string renderer;     ///< OpenGL renderer, e.g. llvmpipe
    std::string failure;      ///< empty, or the failure after which pictures or files stopped
};

/// About how many bytes the data files of one such instant take without compression; the pool, which is not
/// there yet at the start, counts for a tenth of the free surface. Throws VizError for an incomplete
/// snapshot.
std::uint64_t estimate_file_bytes(const Snapshot& snapshot, const FileOptions& options);

/// Turns snapshots into pictures and files on a thread of its own, which owns the render window for the whole
/// run. Nothing that goes wrong there reaches the caller: the first failure of the pictures and the first of
/// the files are each told once through `warn`, and the run goes on without them. All members may be called
/// from any one thread.
class Pipeline {
  public:
    /// Called on the viz thread, with one line of text.
    using Report = std::function<void(const std::string&)>;

    /// Starts the thread; a window is looked for at the first picture. Throws VizError for options that
    /// validate() refuses and for a capacity below 1. `note` hears what is worth logging (the backend and
    /// window class that came).
    Pipeline(FileOptions files, RenderOptions render, Backend backend, BacklogPolicy backlog, Report warn,
             Report note = {});
    /// As finish().
    ~Pipeline();
    Pipeline(const Pipeline&) = delete;
    Pipeline& operator=(const Pipeline&) = delete;

    /// For a run that goes on in its old folder: drops PVD entries and pictures at or after `time` (s) and
    /// goes on counting where the rest end. Call before the first submit. Throws VizError if the folder
    /// cannot be read or written.
    void resume_at(double time);

    /// Queues an instant for pictures (every view chosen), data files, or both. With a full queue it waits,
    /// or (OnFull::drop) gives up the pictures; data files are never dropped.
    void submit(std::shared_ptr<const Snapshot> snapshot, bool render, bool files);

    /// Queues pictures from the files of an earlier run: from the free surface alone, of views_of_surfaces();
    /// `head` is a snapshot without fields. Never dropped.
    void submit_saved(std::shared_ptr<const Snapshot> head, std::filesystem::path surface_file);

    /// Makes one picture outside the run's numbering and waits for it. Throws VizError if it cannot be made.
    void write_image(std::shared_ptr<const Snapshot> snapshot, const std::string& view,
                     const std::filesystem::path& png);

    /// These take effect at the next picture; they throw VizError for what validate() would refuse.
    void set_views(std::vector<std::string> views);
    void set_field(std::string field);
    void set_color_range(std::optional<std::array<double, 2>> range);
    void set_colormap(std::string colormap);
    void set_background(Background background);
    /// As the last sets left them.
    RenderOptions render_options() const;

    /// Waits until all that was queued for instants before `time` (s) is written: what a run that is taken up
    /// at that time does not make again.
    void wait_for_earlier_than(double time);

    /// About how long finish() would take, s: what is queued, each as long as the longest so far.
    double seconds_to_finish() const;

    /// Waits until everything queued is written and ends the thread and its display. Later submits do
    /// nothing.
    void finish();

    PipelineStats stats() const;

  private:
    class Worker;
    std::unique_ptr<Worker> worker_;
};

} // namespace meltscope::viz
