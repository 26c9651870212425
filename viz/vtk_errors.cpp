#include "viz/vtk_errors.hpp"

#include <mutex>

#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

namespace meltscope::viz {

namespace {

/// VTK has one place for its messages in the whole process; this keeps the first error instead of printing.
class QuietWindow : public vtkOutputWindow {
  public:
    vtkTypeMacro(QuietWindow, vtkOutputWindow);
    static QuietWindow* New();

    void DisplayText(const char*) override {}
    void DisplayWarningText(const char*) override {}
    void DisplayGenericWarningText(const char*) override {}
    void DisplayDebugText(const char*) override {}
    void DisplayErrorText(const char* text) override {
        const std::lock_guard lock(mutex_);
        if (first_.empty() && text != nullptr) {
            first_ = text;
        }
    }

    std::string take() {
        const std::lock_guard lock(mutex_);
        std::string words = std::move(first_);
        first_.clear();
        // "ERROR: In file, line n\nvtkClass (0x...): what\n\n": the last line that says something.
        while (!words.empty() && words.back() == '\n') {
            words.pop_back();
        }
        return words.substr(words.rfind('\n') + 1);
    }

  private:
    std::mutex mutex_;
    std::string first_;
};
vtkStandardNewMacro(QuietWindow);

} // namespace

void capture_vtk_errors() {
    // Threads that read and draw at once must not each put one in the place of the other's.
    static std::once_flag once;
    std::call_once(once, [] { vtkOutputWindow::SetInstance(vtkSmartPointer<QuietWindow>::New()); });
}

std::string take_vtk_error() {
    auto* window = QuietWindow::SafeDownCast(vtkOutputWindow::GetInstance());
    return window != nullptr ? window->take() : std::string();
}

} // namespace meltscope::viz
