#include "viz/canvas.hpp"

#include <algorithm>
#include <cmath>

#include <vtkBrush.h>
#include <vtkContext2D.h>
#include <vtkContextItem.h>
#include <vtkContextScene.h>
#include <vtkImageData.h>
#include <vtkObjectFactory.h>
#include <vtkPen.h>
#include <vtkRect.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>

namespace meltscope::viz {

namespace {

constexpr int pixels_per_point_dpi = 72;

unsigned char byte(double value) {
    return static_cast<unsigned char>(std::lround(255.0 * value));
}

void set_pen(vtkContext2D* painter, const Rgb& color, double width) {
    painter->GetPen()->SetLineType(vtkPen::SOLID_LINE);
    painter->GetPen()->SetColor(byte(color[0]), byte(color[1]), byte(color[2]), 255);
    painter->GetPen()->SetWidth(static_cast<float>(width));
}

void set_brush(vtkContext2D* painter, const Rgb& color, double opacity) {
    painter->GetPen()->SetLineType(vtkPen::NO_PEN);
    painter->GetBrush()->SetColor(byte(color[0]), byte(color[1]), byte(color[2]), byte(opacity));
}

void set_text_property(vtkTextProperty* property, const TextStyle& style) {
    constexpr std::array<int, 3> horizontal{VTK_TEXT_LEFT, VTK_TEXT_CENTERED, VTK_TEXT_RIGHT};
    constexpr std::array<int, 3> vertical{VTK_TEXT_BOTTOM, VTK_TEXT_CENTERED, VTK_TEXT_TOP};
    property->SetFontFamilyToArial();
    property->SetFontSize(std::max(4, static_cast<int>(std::lround(style.size))));
    property->SetColor(style.color[0], style.color[1], style.color[2]);
    property->SetBold(style.bold);
    property->SetJustification(horizontal[static_cast<std::size_t>(style.horizontal)]);
    property->SetVerticalJustification(vertical[static_cast<std::size_t>(style.vertical)]);
}

} // namespace

class CanvasItem : public vtkContextItem {
  public:
    vtkTypeMacro(CanvasItem, vtkContextItem);
    static CanvasItem* New();

    bool Paint(vtkContext2D* painter) override {
        for (const auto& command : commands) {
            command(painter);
        }
        return true;
    }

    std::vector<std::function<void(vtkContext2D*)>> commands;
};
vtkStandardNewMacro(CanvasItem);

Canvas::Canvas() : item_(vtkSmartPointer<CanvasItem>::New()) {
    actor_->GetScene()->AddItem(item_);
    renderer_->AddActor(actor_);
    renderer_->InteractiveOff();
}

Canvas::~Canvas() = default;

void Canvas::clear() {
    item_->commands.clear();
}

std::array<double, 2> Canvas::extent(const std::string& words, const TextStyle& style) {
    vtkNew<vtkTextProperty> property;
    set_text_property(property, style);
    int box[4] = {0, 0, 0, 0};
    vtkTextRenderer::GetInstance()->GetBoundingBox(property, words, box, pixels_per_point_dpi);
    return {static_cast<double>(box[1] - box[0] + 1), static_cast<double>(box[3] - box[2] + 1)};
}

void Canvas::text(Pixel at, const std::string& words, const TextStyle& style) {
    if (words.empty()) {
        return;
    }
    TextStyle fitted = style;
    if (style.max_width > 0.0) {
        const double width = extent(words, style)[0];
        fitted.size *= std::min(1.0, style.max_width / width);
    }
    item_->commands.emplace_back([=](vtkContext2D* painter) {
        set_text_property(painter->GetTextProp(), fitted);
        painter->DrawString(static_cast<float>(at[0]), static_cast<float>(at[1]), words);
    });
}

void Canvas::line(const std::vector<Pixel>& points, const Rgb& color, double width) {
    std::vector<float> flat;
    for (const Pixel& point : points) {
        flat.push_back(static_cast<float>(point[0]));
        flat.push_back(static_cast<float>(point[1]));
    }
    item_->commands.emplace_back([flat = std::move(flat), color, width](vtkContext2D* painter) mutable {
        set_pen(painter, color, width);
        painter->DrawPoly(flat.data(), static_cast<int>(flat.size() / 2));
    });
}

void Canvas::fill(const Rect& rect, const Rgb& color, double opacity) {
    item_->commands.emplace_back([=](vtkContext2D* painter) {
        set_brush(painter, color, opacity);
        painter->DrawRect(static_cast<float>(rect.x), static_cast<float>(rect.y),
                          static_cast<float>(rect.width), static_cast<float>(rect.height));
    });
}

void Canvas::frame(const Rect& rect, const Rgb& color, double width) {
    line({{rect.x, rect.y},
          {rect.x + rect.width, rect.y},
          {rect.x + rect.width, rect.y + rect.height},
          {rect.x, rect.y + rect.height},
          {rect.x, rect.y}},
         color, width);
}

void Canvas::gradient(const Rect& rect, vtkLookupTable* colors) {
    const auto rows = static_cast<int>(colors->GetNumberOfTableValues());
    auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(2, rows, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    for (int row = 0; row < rows; ++row) {
        const double* rgba = colors->GetTableValue(row);
        for (int column = 0; column < 2; ++column) {
            for (int channel = 0; channel < 3; ++channel) {
                image->SetScalarComponentFromDouble(column, row, 0, channel,
                                                    std::lround(255.0 * rgba[channel]));
            }
        }
    }
    item_->commands.emplace_back([rect, image](vtkContext2D* painter) {
        painter->DrawImage(vtkRectf(static_cast<float>(rect.x), static_cast<float>(rect.y),
                                    static_cast<float>(rect.width), static_cast<float>(rect.height)),
                           image);
    });
}

void Canvas::triangle(const std::array<Pixel, 3>& corners, const Rgb& color) {
    item_->commands.emplace_back([=](vtkContext2D* painter) {
        std::array<float, 6> flat{};
        for (std::size_t i = 0; i < 3; ++i) {
            flat[2 * i] = static_cast<float>(corners[i][0]);
            flat[2 * i + 1] = static_cast<float>(corners[i][1]);
        }
        set_brush(painter, color, 1.0);
        painter->DrawPolygon(flat.data(), 3);
    });
}

} // namespace meltscope::viz
