#pragma once

#include "meltscope/beam/scan_path.hpp"

#include <cstdint>
#include <optional>

namespace meltscope {

/// Parallel hatch lines over a rectangle parallel to x and y. Lines lie `hatch` apart, centred on the
/// rectangle as seen across them, and end on its edges.
struct RasterSpec {
    Eigen::Vector2d min = Eigen::Vector2d::Zero(); ///< m, lower corner
    Eigen::Vector2d max = Eigen::Vector2d::Zero(); ///< m, upper corner
    double z = 0.0;                                ///< m, height of the path
    double hatch = 0.0;                            ///< m, distance of neighbouring lines
    double angle = 0.0;                            ///< rad, of the first line against x
    double speed = 0.0;                            ///< m/s
    std::optional<double> power;                   ///< W; otherwise the laser's own
    double turn_time = 0.0;                        ///< s, from line to line without light (skywriting)
    bool bidirectional = true;                     ///< every second line is run backwards
    double start_time = 0.0;                       ///< s
};

/// Square islands, each hatched by itself. Islands are laid from the lower corner and cut at the upper edges.
struct IslandSpec {
    RasterSpec raster;        ///< what is done in each island; min and max bound all of them
    double island_size = 0.0; ///< m
    double island_rotation =
        1.5707963267948966; ///< rad, added to the angle in every second island, as on a chessboard
    std::uint64_t seed = 1; ///< of the order in which islands are visited
};

/// Layers on top of each other, each a pattern turned against the one below.
struct LayerSpec {
    int count = 1;
    double thickness = 0.0;               ///< m, rise of the path from layer to layer
    double rotation = 1.1693705988362009; ///< rad, 67 degrees by default
    double pause = 0.0;                   ///< s, without light between layers
};

/// The path of one layer. Throws PathError for what cannot be run: an empty rectangle, a spacing, speed or
/// size that is not above zero, a negative time, or more than ten million lines.
ScanPath make_raster(const RasterSpec& spec);
ScanPath make_island(const IslandSpec& spec);

/// The path of all layers in turn; layer i has the angle + i rotation, the height + i thickness and the seed
/// + i.
ScanPath make_raster_layers(const RasterSpec& spec, const LayerSpec& layers);
ScanPath make_island_layers(const IslandSpec& spec, const LayerSpec& layers);

} // namespace meltscope
