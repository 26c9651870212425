#include "viz/display.hpp"

#include "viz/process.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <X11/Xlib.h>
#include <vtkVersionMacros.h>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

constexpr std::chrono::milliseconds server_start_timeout{60000}; // a busy machine takes its time

// Xlib's own handlers end the process.
int ignore_protocol_error(::Display*, XErrorEvent*) {
    return 0;
}
int ignore_connection_loss(::Display*) {
    return 0;
}
/// Ends the process without the destructors of the GL libraries: they would wait for ever for the lock of a
/// connection that was lost while a call held it. Streams are written out first.
void end_without_closing_displays(int status, void*) {
    static_cast<void>(std::fflush(nullptr)); // nobody is left to be told
    _exit(status);
}

void note_connection_loss(::Display*, void* lost) {
    if (!*static_cast<bool*>(lost)) {
        on_exit(end_without_closing_displays, nullptr);
    }
    *static_cast<bool*>(lost) = true;
}

constexpr bool vtk_chooses_window_at_run_time = VTK_MAJOR_VERSION > 9 ||
                                                (VTK_MAJOR_VERSION == 9 && VTK_MINOR_VERSION >= 4);

} // namespace

Display::Display(Backend wanted) {
    const char* environment = std::getenv("DISPLAY");
    switch (wanted) {
    case Backend::none:
        throw VizError("rendering is switched off");
    case Backend::egl:
    case Backend::osmesa:
        if (!vtk_chooses_window_at_run_time) {
            throw VizError(fmt::format(
                "render backend {} needs VTK 9.4 or later, this is VTK {}.{}; use auto, x11 or xvfb",
                backend_name(wanted), VTK_MAJOR_VERSION, VTK_MINOR_VERSION));
        }
        setenv("VTK_DEFAULT_OPENGL_WINDOW",
               wanted == Backend::egl ? "vtkEGLRenderWindow" : "vtkOSOpenGLRenderWindow", 1);
        backend_ = wanted;
        return;
    case Backend::x11:
        if (environment == nullptr || !connect(environment)) {
            throw VizError(
                environment == nullptr
                    ? std::string(
                          "render backend x11 needs the environment variable DISPLAY; use auto or xvfb")
                    : fmt::format("no X server with GLX answers at DISPLAY={}; use auto or xvfb",
                                  environment));
        }
        backend_ = Backend::x11;
        return;
    case Backend::automatic:
        if (environment != nullptr && *environment != '\0' && connect(environment)) {
            backend_ = Backend::x11;
            return;
        }
        break;
    case Backend::xvfb:
        break;
    }
    start_xvfb();
    backend_ = Backend::xvfb;
}

Display::~Display() {
    if (x_display_ != nullptr && !lost_) {
        XCloseDisplay(static_cast<::Display*>(x_display_));
    }
}

bool Display::connect(const char* name) {
    ::Display* display = XOpenDisplay(name);
    if (display == nullptr) {
        return false;
    }
    int opcode = 0;
    int event = 0;
    int error = 0;
    if (XQueryExtension(display, "GLX", &opcode, &event, &error) == 0) {
        XCloseDisplay(display);
        return false;
    }
    XSetErrorHandler(ignore_protocol_error);
    XSetIOErrorHandler(ignore_connection_loss);
    XSetIOErrorExitHandler(display, note_connection_loss, &lost_);
    x_display_ = display;
    return true;
}

void Display::start_xvfb() {
    const auto program = find_program("Xvfb");
    if (!program) {
        throw VizError("there is no display and no Xvfb to make one; install the package xvfb");
    }
    server_ = std::make_unique<Child>(
        std::vector<std::string>{program->string(), "-displayfd", Child::pipe_word, "-screen", "0",
                                 "1920x1080x24", "-nolisten", "tcp", "-noreset", "+extension", "GLX"});
    const std::string answer = server_->read_until('\n', server_start_timeout);
    if (answer.empty() || answer.back() != '\n') {
        throw VizError("Xvfb did not start; run `Xvfb -displayfd 1` to see why");
    }
    const std::string name = fmt::format(":{}", answer.substr(0, answer.size() - 1));
    if (!connect(name.c_str())) {
        throw VizError(fmt::format("Xvfb started at {} but no connection with GLX could be made", name));
    }
}

} // namespace meltscope::viz
