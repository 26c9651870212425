#pragma once

#include "viz/picture.hpp"

#include <string>
#include <vector>

namespace meltscope::viz {

/// A length with a fitting unit and three digits: "362 µm", "1.25 mm".
std::string format_length(double metres);
/// The largest 1, 2 or 5 times a power of ten not above the value.
double round_down(double value);
/// About `wanted` round numbers inside the range.
std::vector<double> nice_ticks(double low, double high, int wanted);

/// Title on the left and time on the right; below it power, speed and the pool's size.
void draw_caption(Canvas& canvas, const Picture& picture, const Rect& area);
/// The colours with ticks in the field's unit, and for temperature marks at solidus and liquidus.
void draw_color_bar(Canvas& canvas, const Picture& picture, const Rect& area);
/// A horizontal bar of a round length with its label behind it; `pixels_per_metre` holds for the panel.
void draw_scale_bar(Canvas& canvas, const Picture& picture, Pixel lower_left, double pixels_per_metre,
                    double max_pixels);
/// A small heading at the left of an area.
void draw_heading(Canvas& canvas, const Picture& picture, const Rect& area, const std::string& words);

} // namespace meltscope::viz
