#pragma once

#include "viz/colors.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

#include <vtkContextActor.h>
#include <vtkNew.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

namespace meltscope::viz {

using Pixel = std::array<double, 2>; ///< from the lower left corner of the picture

/// A part of the picture, pixels.
struct Rect {
    double x = 0.0;
    double y = 0.0;
    double width = 0.0;
    double height = 0.0;
};

enum class Align { low, middle, high };

struct TextStyle {
    double size = 16.0; ///< pixels
    Rgb color{1.0, 1.0, 1.0};
    Align horizontal = Align::low;
    Align vertical = Align::middle;
    bool bold = false;
    double max_width = 0.0; ///< pixels; longer text is set smaller; 0: no limit
};

class CanvasItem;

/// Flat drawing in pixels over the whole picture, in the order of the calls.
class Canvas {
  public:
    Canvas();
    ~Canvas();
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;

    vtkRenderer* renderer() { return renderer_; }
    vtkContextActor* actor() { return actor_; }

    void clear();
    void text(Pixel at, const std::string& words, const TextStyle& style);
    void line(const std::vector<Pixel>& points, const Rgb& color, double width);
    void fill(const Rect& rect, const Rgb& color, double opacity = 1.0);
    void frame(const Rect& rect, const Rgb& color, double width);
    /// The colours of a table from its low end at the bottom to its high end at the top.
    void gradient(const Rect& rect, vtkLookupTable* colors);
    void triangle(const std::array<Pixel, 3>& corners, const Rgb& color);
    /// Width and height of a text, pixels.
    static std::array<double, 2> extent(const std::string& words, const TextStyle& style);

  private:
    vtkNew<vtkRenderer> renderer_;
    vtkNew<vtkContextActor> actor_;
    vtkSmartPointer<CanvasItem> item_;
};

} // namespace meltscope::viz
