#pragma once

#include "meltscope/build/shapes.hpp"

#include <functional>
#include <vector>

namespace meltscope {

/// Balls in a box from the origin to `size`, and what else is solid there. Lengths in any unit in which a
/// typical diameter is one.
struct BallsInBox {
    Vec3 size = Vec3::Zero();
    std::vector<double> radius;
    std::vector<Vec3> center;
    std::vector<Ball> fixed; ///< balls that do not move
    /// Signed distance to what is solid besides, negative inside; it may change by no more than the way gone.
    std::function<double(const Vec3&)> distance;
};

/// Direction away from what `distance` describes, at ball i.
Vec3 ground_normal(const BallsInBox& bed, std::size_t i);

/// Moves balls that overlap apart, down the gradient of their elastic energy, until no overlap (with each
/// other, what is fixed and the box's sides) is above the allowed one, given as a share of the smaller
/// diameter. Returns whether that was reached. Method: FIRE (Bitzek et al. 2006, Phys. Rev. Lett. 97,
/// 170201).
bool part_balls(BallsInBox& bed, double allowed_overlap);

/// Lets balls fall and roll, one after the other from the lowest, until each rests: nothing that it touches
/// lets it move down. No overlap grows and no ball rises. (The falling and rolling of Visscher and Bolsterli
/// 1972, Nature 239, 504, repeated with all other balls in place.)
void settle_balls(BallsInBox& bed);

/// Largest overlap of a ball with anything, as a share of the smaller diameter; zero if nothing overlaps.
double largest_overlap(const BallsInBox& bed);

} // namespace meltscope
