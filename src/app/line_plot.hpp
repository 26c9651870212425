#pragma once

#include <string>
#include <vector>

namespace meltscope {

/// Values over a common abscissa; those that are not finite leave a gap.
struct Curve {
    std::string name; ///< for the legend
    std::vector<double> values;
};

/// A level that is marked by a dashed line if it lies among the values.
struct LevelMark {
    std::string name;
    double value = 0.0;
};

struct LinePlot {
    std::string title;
    std::string x_label, y_label; ///< with units
    std::vector<double> x;        ///< rising
    std::vector<Curve> curves;
    std::vector<LevelMark> marks;
    bool from_zero = true; ///< the ordinate includes zero
};

/// The plot as an SVG element for a page whose style knows the classes grid, frame, mark, curve and c0 to c3.
/// Long curves are thinned to what the eye can tell apart, peaks kept.
std::string to_svg(const LinePlot& plot);

} // namespace meltscope
