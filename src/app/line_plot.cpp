#include "line_plot.hpp"

#include "html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope {
namespace {

constexpr double width = 520.0, height = 270.0; ///< of the picture, in its own units
constexpr double left = 64.0, right = 16.0, top = 26.0, bottom = 46.0;

struct Axis {
    double low = 0.0, high = 1.0;  ///< shown range, whole steps
    double step = 1.0;             ///< between ticks
    double start = 0.0, end = 0.0; ///< where low and high are drawn

    double operator()(double value) const { return start + (end - start) * (value - low) / (high - low); }
    int tick_count() const { return int(std::lround((high - low) / step)) + 1; }
    std::string tick(int n) const {
        const int decimals = std::clamp(-int(std::floor(std::log10(step) + 1e-9)), 0, 9);
        const double value = low + n * step;
        return fmt::format("{:.{}f}", std::abs(value) < 1e-6 * step ? 0.0 : value, decimals);
    }
};

/// The least of 1, 2 and 5 times a power of ten that is no less than a value.
double round_step(double value) {
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (value <= factor * power * (1.0 + 1e-9))
            return factor * power;
    return 10.0 * power;
}

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void include(double value) {
        if (std::isfinite(value)) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    }
    bool empty() const { return low > high; }
};

Axis make_axis(Range range, int steps_wanted, double start, double end) {
    if (range.empty())
        range = {0.0, 1.0};
    if (range.high - range.low <= 1e-9 * std::max(std::abs(range.low), std::abs(range.high)))
        range.high = range.low + std::max(1e-3 * std::abs(range.low), range.low == 0.0 ? 1.0 : 0.0);
    Axis axis;
    axis.step = round_step((range.high - range.low) / steps_wanted);
    axis.low = std::floor(range.low / axis.step + 1e-9) * axis.step;
    axis.high = std::ceil(range.high / axis.step - 1e-9) * axis.step;
    axis.start = start;
    axis.end = end;
    return axis;
}

std::string text(double x, double y, const char* anchor, const std::string& words) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", x, y, anchor,
                       escape_html(words));
}

std::string line(const char* kind, double x1, double y1, double x2, double y2) {
    return fmt::format("<line class=\"{}\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>", kind,
                       x1, y1, x2, y2);
}

/// Which points of a curve are drawn: all, or of each stretch half a unit wide the lowest and the highest.
std::vector<std::size_t> points_to_draw(const std::vector<double>& values) {
    const auto stretches = std::size_t(2.0 * (width - left - right));
    std::vector<std::size_t> chosen;
    const std::size_t stride = values.size() > 2 * stretches ? values.size() / stretches : 1;
    for (std::size_t from = 0; from < values.size(); from += stride) {
        std::size_t low = from, high = from;
        for (std::size_t n = from; n < std::min(from + stride, values.size()); ++n) {
            low = values[n] < values[low] ? n : low;
            high = values[n] > values[high] ? n : high;
        }
        chosen.push_back(std::min(low, high));
        if (low != high)
            chosen.push_back(std::max(low, high));
    }
    return chosen;
}

std::string draw_curve(const LinePlot& plot, std::size_t number, const Axis& x, const Axis& y) {
    std::string svg, points;
    const auto end_stretch = [&] {
        if (!points.empty())
            svg += fmt::format("<polyline class=\"curve c{}\" points=\"{}\"/>", number % 4, points);
        points.clear();
    };
    const std::vector<double>& values = plot.curves[number].values;
    for (const std::size_t n : points_to_draw(values)) {
        if (!std::isfinite(values[n]) || !std::isfinite(plot.x[n]))
            end_stretch();
        else
            points += fmt::format("{}{:.1f},{:.1f}", points.empty() ? "" : " ", x(plot.x[n]), y(values[n]));
    }
    end_stretch();
    return svg;
}

/// A row above the frame, where no curve runs.
std::string draw_legend(const LinePlot& plot) {
    std::string svg;
    for (std::size_t n = 0; n < plot.curves.size(); ++n) {
        const double at = left + 110.0 * double(n);
        svg += fmt::format("<line class=\"curve c{}\" x1=\"{:.1f}\" y1=\"11\" x2=\"{:.1f}\" y2=\"11\"/>",
                           n % 4, at, at + 20.0);
        svg += text(at + 26.0, 15.0, "start", plot.curves[n].name);
    }
    return svg;
}

} // namespace

std::string to_svg(const LinePlot& plot) {
    Range across, up;
    for (const double value : plot.x)
        across.include(value);
    for (const Curve& curve : plot.curves)
        for (const double value : curve.values)
            up.include(value);
    if (plot.from_zero)
        up.include(0.0);
    const Axis x = make_axis(across, 6, left, width - right);
    const Axis y = make_axis(up, 5, height - bottom, top);

    std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">", width, height,
                                  escape_html(plot.title));
    for (int n = 0; n < x.tick_count(); ++n) {
        const double at = x(x.low + n * x.step);
        svg += line("grid", at, top, at, height - bottom);
        svg += text(at, height - bottom + 17.0, "middle", x.tick(n));
    }
    for (int n = 0; n < y.tick_count(); ++n) {
        const double at = y(y.low + n * y.step);
        svg += line(y.low + n * y.step == 0.0 ? "frame" : "grid", left, at, width - right, at);
        svg += text(left - 7.0, at + 4.0, "end", y.tick(n));
    }
    svg += line("frame", left, top, left, height - bottom);
    svg += line("frame", left, height - bottom, width - right, height - bottom);
    svg += text(0.5 * (left + width - right), height - 8.0, "middle", plot.x_label);
    svg +=
        fmt::format("<text transform=\"translate(14 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
                    0.5 * (top + height - bottom), escape_html(plot.y_label));
    for (const LevelMark& mark : plot.marks) {
        if (mark.value <= y.low || mark.value >= y.high)
            continue;
        const double at = y(mark.value);
        svg += line("mark", left, at, width - right, at);
        svg += text(width - right - 4.0, at - 4.0, "end", mark.name);
    }
    for (std::size_t n = 0; n < plot.curves.size(); ++n)
        svg += draw_curve(plot, n, x, y);
    if (plot.curves.size() > 1)
        svg += draw_legend(plot);
    return svg + "</svg>";
}

} // namespace meltscope
