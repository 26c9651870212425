#pragma once

#include "meltscope/build/shapes.hpp"

#include <cstdint>
#include <functional>
#include <vector>

namespace meltscope {

/// What d10, d50 and d90 count: balls, or the volume that the balls hold (as laser diffraction reports it).
enum class PercentileBasis { number, volume };

/// A layer of powder: balls of log-normal diameters, packed at random and settled along -z.
struct PowderSpec {
    Box box;              ///< m, the layer; all balls stay inside
    double d10 = 0.0;     ///< m, a tenth is finer
    double d50 = 0.0;     ///< m, half is finer
    double d90 = 0.0;     ///< m, nine tenths are finer
    double packing = 0.5; ///< volume of the balls by the volume of the box that is free
    std::uint64_t seed = 1;
    PercentileBasis basis = PercentileBasis::number;
};

/// What the powder comes to lie on besides the box's floor; both may be given.
struct PowderGround {
    std::vector<Ball> balls; ///< that stay where they are
    /// Signed distance (m) to the surface of what is solid, negative inside; called from one thread. It may
    /// change by no more than the way gone, as a distance does.
    std::function<double(const Vec3&)> distance;
};

/// Diameters (m) of `count` balls, in random order. The distribution is log-normal with its own width below
/// and above the median, so that all three percentiles are met. Diameters beyond the 1 % and 99 % quantiles
/// are set to these, and those above the box's thinnest side to that: the blade takes coarser balls away. One
/// is drawn from each of `count` equally probable parts, so that few balls already have the percentiles.
/// Throws GeometryError unless 0 < d10 <= d50 <= d90 <= the box's thinnest side.
std::vector<double> draw_diameters(const PowderSpec& spec, std::size_t count);

/// Packs the layer: balls at random places are moved apart until they do not overlap, then fall and roll
/// until each rests on three others, the sides, the floor or the ground. No two overlap by more than one per
/// cent of the smaller diameter. The same spec gives the same balls, bit for bit. Throws GeometryError for
/// meaningless numbers, and for a packing that cannot be reached, with one that can.
std::vector<Ball> pack_powder(const PowderSpec& spec, const PowderGround& ground = {});

} // namespace meltscope
