#pragma once

#include "meltscope/build/shapes.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace meltscope {

/// Sites of a cubic lattice: site (i,j,k) lies at origin + spacing (i,j,k).
struct Lattice {
    Vec3 origin = Vec3::Zero();    ///< m
    double spacing = 0.0;          ///< m
    Index3 count = Index3::Zero(); ///< sites along x, y, z
};

/// Tells for each site of a lattice which body it lies in, layer by layer, so that no more than a layer need
/// be held. A later body replaces an earlier one. Each site is asked for at its place plus 1e-9 spacings
/// along x, y and z: a face that coincides with sites up to rounding then always falls to the same side (see
/// `contains`).
class LatticeFill {
  public:
    /// Sorts what the bodies hold by layer. Keeps a reference to the bodies. Throws GeometryError for more
    /// than 32767 bodies, shapes that check_shape refuses or a lattice without spacing.
    LatticeFill(std::span<const Shape> bodies, const Lattice& lattice);

    /// Writes the body's index, or -1, for all sites of layer k, x fastest, into `sites` (count x * count y).
    /// Safe to call from several threads.
    void layer(std::int64_t k, std::span<std::int16_t> sites) const;

  private:
    /// Balls or triangles of one body, listed for each layer that they meet.
    struct Buckets {
        std::vector<std::size_t> first; ///< into items, one entry a layer and one more
        std::vector<std::uint32_t> items;
    };
    std::span<const Shape> bodies_;
    Lattice lattice_;
    std::vector<Buckets> buckets_; ///< one a body; empty for bodies of one piece
};

/// The body's index, or -1, for every site of the lattice, x fastest; two bytes a site, made by all threads.
std::vector<std::int16_t> fill(std::span<const Shape> bodies, const Lattice& lattice);

} // namespace meltscope
