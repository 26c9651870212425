#pragma once

#include "viz/options.hpp"

#include <memory>

namespace meltscope::viz {

class Child;

/// The X display that the render window lives on, checked before VTK sees it: VTK ends the whole process when
/// its display cannot be opened or has no GLX. With VTK 9.4 or later it may also be none at all (EGL,
/// OSMesa).
class Display {
  public:
    /// `automatic` takes the usable DISPLAY of the environment, else a private Xvfb. Throws VizError with the
    /// reason when there is none. To be called on the thread that renders: the private Xvfb ends with that
    /// thread.
    explicit Display(Backend wanted);
    ~Display();
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;

    Backend backend() const { return backend_; }
    /// Xlib's Display*; null for egl and osmesa.
    void* x_display() const { return x_display_; }
    /// True once the connection to the X server is gone; then nothing on it may be touched again.
    bool lost() const { return lost_; }

  private:
    bool connect(const char* name);
    void start_xvfb();

    Backend backend_ = Backend::none;
    void* x_display_ = nullptr;
    bool lost_ = false;
    std::unique_ptr<Child> server_;
};

} // namespace meltscope::viz
