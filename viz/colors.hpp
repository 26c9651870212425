#pragma once

#include "viz/options.hpp"

#include <array>
#include <string>

#include <vtkLookupTable.h>
#include <vtkSmartPointer.h>

namespace meltscope::viz {

using Rgb = std::array<double, 3>; ///< 0 to 1

/// The colours of everything that is not a field.
struct Theme {
    Rgb background;
    Rgb text;  ///< captions, axes
    Rgb muted; ///< frames, ticks, box edges
    Rgb panel_edge;
    Rgb liquidus; ///< lines on the material, which is dark in both themes
    Rgb solidus;
    Rgb path_done;
    Rgb path_to_come;
    Rgb beam;
    std::array<Rgb, 4> series; ///< lines of the charts
};

const Theme& theme(Background background);

/// 256 colours of the map over [range[0], range[1]]; values outside take the end colours, NaN is grey.
/// Maps that start at black are brightened a little towards white, least where they are bright.
vtkSmartPointer<vtkLookupTable> make_lookup_table(const std::string& colormap,
                                                  const std::array<double, 2>& range);

} // namespace meltscope::viz
