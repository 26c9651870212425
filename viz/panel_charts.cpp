#include "viz/annotations.hpp"
#include "viz/panel.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include <vtkAxis.h>
#include <vtkChartXY.h>
#include <vtkContextActor.h>
#include <vtkContextScene.h>
#include <vtkDoubleArray.h>
#include <vtkPen.h>
#include <vtkPlot.h>
#include <vtkTable.h>
#include <vtkTextProperty.h>

namespace meltscope::viz {

namespace {

struct Series {
    const char* name;
    const char* name_of_several; ///< with several lasers
    double HistoryPoint::*value;
    double factor; ///< from SI to the chart's unit
};

/// One chart over time with its heading: what is shown, each word in the colour of its line.
class TimeChart {
  public:
    TimeChart(vtkContextScene* scene, std::string unit, std::vector<Series> series)
        : unit_(std::move(unit)), series_(std::move(series)) {
        time_->SetName("time");
        table_->AddColumn(time_);
        for (const Series& one : series_) {
            vtkNew<vtkDoubleArray> column;
            column->SetName(one.name);
            table_->AddColumn(column);
        }
        for (std::size_t i = 0; i < series_.size(); ++i) {
            plots_.push_back(chart_->AddPlot(vtkChart::LINE));
        }
        chart_->SetLayoutStrategy(vtkChart::AXES_TO_RECT);
        chart_->SetShowLegend(false);
        scene->AddItem(chart_);
    }

    /// `area` in pixels of the picture, `offset` the corner of the scene in it.
    void update(const Picture& picture, const Rect& area, const Pixel& offset, Canvas& canvas) {
        const std::vector<HistoryPoint>& history = *picture.history;
        // A lone point is given twice: a chart without a line shows no axes either.
        const auto rows =
            history.empty() ? 0 : std::max<vtkIdType>(2, static_cast<vtkIdType>(history.size()));
        const double last = history.empty() ? 0.0 : history.back().time;
        const bool milliseconds = last >= 1e-3;
        table_->SetNumberOfRows(rows);
        double highest = 0.0;
        for (vtkIdType row = 0; row < rows; ++row) {
            const HistoryPoint& point = history[std::min(static_cast<std::size_t>(row), history.size() - 1)];
            table_->SetValue(row, 0, point.time * (milliseconds ? 1e3 : 1e6));
            for (std::size_t i = 0; i < series_.size(); ++i) {
                const double value = point.*(series_[i].value) * series_[i].factor;
                highest = std::max(highest, value);
                table_->SetValue(row, static_cast<vtkIdType>(i) + 1, value);
            }
        }
        table_->Modified();
        for (std::size_t i = 0; i < series_.size(); ++i) {
            const Rgb& color = picture.theme->series.at(i);
            plots_[i]->SetVisible(rows > 0);
            if (rows > 0) {
                plots_[i]->SetInputData(table_, 0, static_cast<vtkIdType>(i) + 1);
            }
            plots_[i]->SetColor(color[0], color[1], color[2]);
            plots_[i]->SetWidth(static_cast<float>(1.5 * picture.line));
        }
        const double top = highest > 0.0 ? 1.08 * highest : 1.0;
        const double end = std::max(last, 1e-9) * (milliseconds ? 1e3 : 1e6);
        style_axis(chart_->GetAxis(vtkAxis::BOTTOM), picture, end);
        style_axis(chart_->GetAxis(vtkAxis::LEFT), picture, top);

        // The chart's own layout keeps distances in pixels, too small for large pictures: room for the
        // numbers is made here, and the time's title drawn.
        TextStyle style;
        style.size = number_size(picture);
        style.color = picture.theme->muted;
        style.horizontal = Align::middle;
        style.vertical = Align::low;
        double widest = 0.0;
        for (const double tick : nice_ticks(0.0, top, tick_count)) {
            widest = std::max(widest, Canvas::extent(fmt::format("{:g}", tick), style)[0]);
        }
        const double left = widest + number_distance(picture) + tick_length(picture);
        const double bottom = number_distance(picture) + tick_length(picture) + 2.1 * style.size;
        const double heading = 2.0 * picture.font;
        const double right =
            0.6 * picture.font + 0.5 * widest; // half of the last time stands beside the axis
        chart_->SetSize(vtkRectf(static_cast<float>(area.x + left - offset[0]),
                                 static_cast<float>(area.y + bottom - offset[1]),
                                 static_cast<float>(area.width - left - right),
                                 static_cast<float>(area.height - heading - bottom)));
        draw_names(picture, area, canvas);
        canvas.text({area.x + left + 0.5 * (area.width - left - right), area.y},
                    milliseconds ? "time (ms)" : "time (µs)", style);
    }

  private:
    static constexpr int tick_count = 4;
    /// Pixels.
    static double number_size(const Picture& picture) { return 0.8 * picture.font; }
    static double number_distance(const Picture& picture) { return 0.5 * picture.font; }
    static double tick_length(const Picture& picture) { return 0.3 * picture.font; }

    static void style_axis(vtkAxis* axis, const Picture& picture, double end) {
        const Theme& colors = *picture.theme;
        vtkTextProperty* property = axis->GetLabelProperties();
        property->SetColor(colors.muted[0], colors.muted[1], colors.muted[2]);
        property->SetFontSize(std::max(6, static_cast<int>(std::lround(number_size(picture)))));
        property->SetBold(false);
        axis->SetTitle("");
        axis->GetPen()->SetColorF(colors.muted[0], colors.muted[1], colors.muted[2]);
        axis->GetPen()->SetWidth(static_cast<float>(0.6 * picture.line));
        axis->GetGridPen()->SetColorF(colors.panel_edge[0], colors.panel_edge[1], colors.panel_edge[2]);
        axis->GetGridPen()->SetWidth(static_cast<float>(0.5 * picture.line));
        axis->SetLabelOffset(static_cast<float>(number_distance(picture)));
        axis->SetTickLength(static_cast<float>(tick_length(picture)));
        axis->SetBehavior(vtkAxis::FIXED);
        axis->SetRange(0.0, end);
        vtkNew<vtkDoubleArray> positions;
        for (const double tick : nice_ticks(0.0, end, tick_count)) {
            positions->InsertNextValue(tick);
        }
        axis->SetCustomTickPositions(positions);
    }

    void draw_names(const Picture& picture, const Rect& area, Canvas& canvas) const {
        const bool several = picture.instant->snapshot->beams.size() > 1;
        TextStyle style;
        style.size = 0.9 * picture.font;
        style.vertical = Align::high;
        double x = area.x;
        for (std::size_t i = 0; i < series_.size(); ++i) {
            style.color = picture.theme->series.at(i);
            const std::string name = several ? series_[i].name_of_several : series_[i].name;
            canvas.text({x, area.y + area.height - 0.3 * picture.font}, name, style);
            x += Canvas::extent(name, style)[0] + picture.font;
        }
        style.color = picture.theme->muted;
        canvas.text({x, area.y + area.height - 0.3 * picture.font}, "(" + unit_ + ")", style);
    }

    std::string unit_;
    std::vector<Series> series_;
    vtkNew<vtkChartXY> chart_;
    vtkNew<vtkTable> table_;
    vtkNew<vtkDoubleArray> time_;
    std::vector<vtkPlot*> plots_;
};

/// Pool size and laser power over time, so far.
class ChartsPanel : public Panel {
  public:
    ChartsPanel() { renderer_->AddActor(actor_); }

    void update(const Picture& picture, const Rect& area, Canvas& canvas) override {
        place(picture, area);
        const Pixel corner{area.x, area.y};
        const double gap = picture.font;
        const double half = 0.5 * (area.width - gap);
        pool_.update(picture, {area.x, area.y, half, area.height}, corner, canvas);
        power_.update(picture, {area.x + half + gap, area.y, half, area.height}, corner, canvas);
    }

  private:
    vtkNew<vtkContextActor> actor_;
    TimeChart pool_{actor_->GetScene(),
                    "µm",
                    {{"pool length", "pool length", &HistoryPoint::length, 1e6},
                     {"width", "width", &HistoryPoint::width, 1e6},
                     {"depth", "depth", &HistoryPoint::depth, 1e6}}};
    TimeChart power_{
        actor_->GetScene(), "W", {{"laser power", "power of all lasers", &HistoryPoint::power, 1.0}}};
};

} // namespace

std::unique_ptr<Panel> make_charts_panel() {
    return std::make_unique<ChartsPanel>();
}

} // namespace meltscope::viz
