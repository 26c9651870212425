#include "viz/annotations.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace meltscope::viz {

namespace {

struct Scaled {
    double factor;
    const char* unit;
};

Scaled length_unit(double metres) {
    if (metres >= 1.0) {
        return {1.0, "m"};
    }
    return metres >= 1e-3 ? Scaled{1e3, "mm"} : Scaled{1e6, "µm"};
}

std::string three_digits(double value) {
    const double size = std::abs(value);
    return fmt::format("{:.{}f}", value, size >= 99.95 ? 0 : size >= 9.995 ? 1 : 2);
}

std::string format_time(double seconds) {
    if (seconds >= 1.0) {
        return fmt::format("{:.4f} s", seconds);
    }
    return seconds >= 1e-3 ? fmt::format("{:.3f} ms", seconds * 1e3)
                           : fmt::format("{:.1f} µs", seconds * 1e6);
}

std::string describe_power(const BeamSnapshot& beam) {
    if (!beam.on || !(beam.power > 0.0)) {
        return "laser off";
    }
    return beam.speed > 0.0
               ? fmt::format("{} W at {} m/s", three_digits(beam.power), three_digits(beam.speed))
               : fmt::format("{} W, standing", three_digits(beam.power));
}

std::string describe_size(const PoolFigures& pool) {
    const Scaled scale = length_unit(pool.length);
    return fmt::format("melt pool {} × {} × {} {}", three_digits(pool.length * scale.factor),
                       three_digits(pool.width * scale.factor), three_digits(pool.depth * scale.factor),
                       scale.unit);
}

/// Power, speed and pool; with several lasers those of each, unless they share one pool.
std::string describe_beams_and_pools(const Snapshot& snapshot) {
    const PoolFigures pool = shown_pool(snapshot);
    const std::string size =
        pool.length > 0.0 ? describe_size(pool) + " (length × width × depth)" : "no melt pool";
    if (snapshot.beams.size() <= 1) {
        return (snapshot.beams.empty() ? "no laser" : describe_power(snapshot.beams.front())) + "      " +
               size;
    }
    const bool one_pool =
        std::any_of(snapshot.separate_pools.begin(), snapshot.separate_pools.end(),
                    [&](const SeparatePool& joined) { return joined.beams.size() == snapshot.beams.size(); });
    std::string words;
    for (const BeamSnapshot& beam : snapshot.beams) {
        words += (words.empty() ? "" : "      ") + beam.name + ": " + describe_power(beam);
        if (!one_pool && !beam.pools.empty() && beam.pools.front().length > 0.0) {
            words += ", " + describe_size(beam.pools.front());
        }
    }
    return one_pool ? words + "      one " + size : words;
}

std::string field_title(const std::string& field) {
    if (field == "temperature") {
        return "temperature (K)";
    }
    if (field == "phi") {
        return "signed distance (m)";
    }
    return field == "mass" ? "node mass (kg)" : "regularised level set";
}

} // namespace

std::string format_length(double metres) {
    const Scaled scale = length_unit(metres * (1.0 + 1e-9));
    return fmt::format("{:.3g} {}", metres * scale.factor, scale.unit);
}

double round_down(double value) {
    const double power = std::pow(10.0, std::floor(std::log10(value * (1.0 + 1e-9))));
    const double lead = value * (1.0 + 1e-9) / power;
    return power * (lead >= 5.0 ? 5.0 : lead >= 2.0 ? 2.0 : 1.0);
}

std::vector<double> nice_ticks(double low, double high, int wanted) {
    std::vector<double> ticks;
    if (!(high > low)) {
        return ticks;
    }
    double step = round_down((high - low) / wanted);
    while ((high - low) / step > 1.8 * wanted) {
        step = round_down(step * 2.6);
    }
    for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1.0) {
        ticks.push_back(i * step + 0.0); // no minus zero
    }
    return ticks;
}

void draw_caption(Canvas& canvas, const Picture& picture, const Rect& area) {
    const Snapshot& snapshot = *picture.instant->snapshot;
    TextStyle style;
    style.size = 1.15 * picture.font;
    style.color = picture.theme->text;
    const double upper = area.y + 0.68 * area.height;
    const double lower = area.y + 0.24 * area.height;

    TextStyle time = style;
    time.horizontal = Align::high;
    const std::string clock = "t = " + format_time(snapshot.time);
    canvas.text({area.x + area.width, upper}, clock, time);

    style.bold = true;
    style.max_width = area.width - Canvas::extent(clock, time)[0] - 2.0 * picture.font;
    canvas.text({area.x, upper}, snapshot.title, style);

    style.bold = false;
    style.size = picture.font;
    style.color = picture.theme->muted;
    style.max_width = area.width;
    canvas.text(
        {area.x, lower},
        fmt::format("{}      peak {:.0f} K", describe_beams_and_pools(snapshot), snapshot.peak_temperature),
        style);
}

void draw_color_bar(Canvas& canvas, const Picture& picture, const Rect& area) {
    const double font = picture.font;
    const double title_height = 1.8 * font;
    const Rect bar{area.x, area.y + 0.8 * font, 1.15 * font, area.height - title_height - 1.6 * font};
    const double low = picture.range[0], high = picture.range[1];
    const auto height_of = [&](double value) { return bar.y + bar.height * (value - low) / (high - low); };

    TextStyle style;
    style.size = font;
    style.color = picture.theme->text;
    style.vertical = Align::high;
    style.max_width = area.width;
    canvas.text({area.x, area.y + area.height}, field_title(picture.field), style);

    canvas.gradient(bar, picture.colors);
    canvas.frame(bar, picture.theme->muted, 0.6 * picture.line);

    const Snapshot& snapshot = *picture.instant->snapshot;
    const bool thermal = picture.field == "temperature";
    if (thermal && snapshot.peak_temperature > high) {
        // The hottest material is off the scale: a tip on the bar, as is usual.
        double rgb[3];
        picture.colors->GetColor(high, rgb);
        const double top = bar.y + bar.height;
        const std::array<Pixel, 3> tip{
            {{bar.x, top}, {bar.x + 0.5 * bar.width, top + 0.7 * font}, {bar.x + bar.width, top}}};
        canvas.triangle(tip, {rgb[0], rgb[1], rgb[2]});
        canvas.line({tip.begin(), tip.end()}, picture.theme->muted, 0.6 * picture.line);
    }

    const double text_x = bar.x + bar.width + 0.55 * font;
    const double tick_end = bar.x + bar.width + 0.3 * font;
    std::vector<std::array<double, 2>> taken; // heights between which text stands
    const auto is_free = [&](double from, double to) {
        return std::none_of(taken.begin(), taken.end(),
                            [&](const auto& span) { return from < span[1] && to > span[0]; });
    };
    style.size = 0.92 * font;
    style.vertical = Align::middle;
    style.max_width = area.x + area.width - text_x;
    if (thermal) {
        const bool both = snapshot.liquidus - snapshot.solidus > 0.0;
        const double middle = 0.5 * (height_of(snapshot.liquidus) + height_of(snapshot.solidus));
        const double apart =
            std::max(0.5 * (height_of(snapshot.liquidus) - height_of(snapshot.solidus)), 0.62 * font);
        const auto mark = [&](double value, double text_y, const char* name) {
            if (value < low || value > high) {
                return;
            }
            const double y = height_of(value);
            canvas.line({{bar.x, y}, {bar.x + bar.width, y}}, picture.theme->liquidus, picture.line);
            canvas.line({{bar.x + bar.width, y}, {text_x - 0.15 * font, text_y}}, picture.theme->text,
                        0.6 * picture.line);
            canvas.text({text_x, text_y}, fmt::format("{:.0f} {}", value, name), style);
            taken.push_back({text_y - 0.6 * font, text_y + 0.6 * font});
        };
        mark(snapshot.liquidus, both ? middle + apart : height_of(snapshot.liquidus), "liquidus");
        if (both) {
            mark(snapshot.solidus, middle - apart, "solidus");
        }
    }
    style.color = picture.theme->muted;
    for (const double tick : nice_ticks(low, high, 6)) {
        const double y = height_of(tick);
        if (is_free(y - 0.5 * font, y + 0.5 * font)) {
            canvas.line({{bar.x + bar.width, y}, {tick_end, y}}, picture.theme->muted, 0.6 * picture.line);
            canvas.text({text_x, y},
                        fmt::format("{:.4g}", std::abs(tick) < 1e-12 * (high - low) ? 0.0 : tick), style);
        }
    }
}

void draw_scale_bar(Canvas& canvas, const Picture& picture, Pixel lower_left, double pixels_per_metre,
                    double max_pixels) {
    const double length = round_down(max_pixels / pixels_per_metre);
    const double width = length * pixels_per_metre;
    const double tick = 0.3 * picture.font;
    const auto [x, y] = lower_left;
    canvas.line({{x, y - tick}, {x, y + tick}}, picture.theme->text, picture.line);
    canvas.line({{x + width, y - tick}, {x + width, y + tick}}, picture.theme->text, picture.line);
    canvas.line({{x, y}, {x + width, y}}, picture.theme->text, picture.line);
    TextStyle style;
    style.size = picture.font;
    style.color = picture.theme->text;
    canvas.text({x + width + 0.6 * picture.font, y}, format_length(length), style);
}

void draw_heading(Canvas& canvas, const Picture& picture, const Rect& area, const std::string& words) {
    TextStyle style;
    style.size = 0.95 * picture.font;
    style.color = picture.theme->muted;
    style.max_width = area.width;
    canvas.text({area.x, area.y + 0.5 * area.height}, words, style);
}

} // namespace meltscope::viz
