#pragma once

#include "row_interval.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace meltscope {

/// One edge of the closed polygons in which a plane of constant z cuts a closed mesh; the inside is to its
/// left.
struct SectionEdge {
    Eigen::Vector2d begin;
    Eigen::Vector2d end;
};

/// Where a row parallel to x crosses a section: at x, into the solid (+1) or out of it (-1).
struct MeshCrossing {
    double x = 0.0;
    int turn = 0;
};

/// Cuts the triangles named by the plane at z (m). A point at the plane's height counts as above it, so every
/// triangle gives one edge or none; its ends lie on mesh edges and are worked out alike for both neighbours,
/// so that the polygons of a closed mesh close to the last bit.
std::vector<SectionEdge> cut_mesh(const Solid& solid, std::span<const std::uint32_t> triangles, double z);

/// Stretches of the row at y (m) inside the section: where the winding number is above zero. `crossings` is
/// scratch, kept by the caller to spare memory requests.
std::vector<RowInterval> row_intervals(std::span<const SectionEdge> section, double y,
                                       std::vector<MeshCrossing>& crossings);

} // namespace meltscope
