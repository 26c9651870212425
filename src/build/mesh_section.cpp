#include "mesh_section.hpp"

#include <algorithm>
#include <array>

namespace meltscope {

namespace {

/// Where the mesh edge between two points meets the plane; points are ordered so that the neighbour agrees.
Eigen::Vector2d cut_edge(const Solid& solid, std::uint32_t one, std::uint32_t other, double z) {
    const Vec3& low = solid.points[std::min(one, other)];
    const Vec3& high = solid.points[std::max(one, other)];
    const double share = (z - low.z()) / (high.z() - low.z());
    return low.head<2>() + share * (high - low).head<2>();
}

} // namespace

std::vector<SectionEdge> cut_mesh(const Solid& solid, std::span<const std::uint32_t> triangles, double z) {
    std::vector<SectionEdge> section;
    for (const std::uint32_t index : triangles) {
        const std::array<std::uint32_t, 3>& triangle = solid.triangles[index];
        SectionEdge edge;
        int found = 0;
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t from = triangle[static_cast<std::size_t>(i)];
            const std::uint32_t to = triangle[static_cast<std::size_t>((i + 1) % 3)];
            const bool from_above = solid.points[from].z() >= z;
            const bool to_above = solid.points[to].z() >= z;
            if (from_above == to_above) {
                continue;
            }
            // Seen from above, with the outside to the right, a section edge begins where the triangle's
            // border comes down through the plane and ends where it goes up again.
            (from_above ? edge.begin : edge.end) = cut_edge(solid, from, to, z);
            ++found;
        }
        if (found == 2) {
            section.push_back(edge);
        }
    }
    return section;
}

std::vector<RowInterval> row_intervals(std::span<const SectionEdge> section, double y,
                                       std::vector<MeshCrossing>& crossings) {
    crossings.clear();
    for (const SectionEdge& edge : section) {
        const bool begin_above = edge.begin.y() >= y;
        const bool end_above = edge.end.y() >= y;
        if (begin_above == end_above) {
            continue;
        }
        const double share = (y - edge.begin.y()) / (edge.end.y() - edge.begin.y());
        // The inside lies to the left of an edge: an edge that comes down has it towards larger x.
        crossings.push_back({edge.begin.x() + share * (edge.end.x() - edge.begin.x()), begin_above ? 1 : -1});
    }
    std::sort(crossings.begin(), crossings.end(), [](const MeshCrossing& a, const MeshCrossing& b) {
        return a.x < b.x || (a.x == b.x && a.turn > b.turn);
    });
    std::vector<RowInterval> intervals;
    int winding = 0;
    double entered = 0.0;
    for (const MeshCrossing& crossing : crossings) {
        const int before = winding;
        winding += crossing.turn;
        if (before <= 0 && winding > 0) {
            entered = crossing.x;
        } else if (before > 0 && winding <= 0) {
            intervals.push_back({entered, crossing.x});
        }
    }
    return intervals;
}

} // namespace meltscope
