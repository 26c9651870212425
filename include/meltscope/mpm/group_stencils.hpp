#pragma once

#include "meltscope/mpm/particles.hpp"
#include "meltscope/mpm/stencil.hpp"

namespace meltscope {

/// The stencils of all lattices that exist, made once a pass: their weights are the same in every bin.
struct LatticeStencils {
    LatticeStencil<1> one;
    LatticeStencil<2> two;
    LatticeStencil<3> three;
    LatticeStencil<4> four;

    LatticeStencils() {
        fill(one);
        fill(two);
        fill(three);
        fill(four);
    }

  private:
    template <int n>
    static void fill(LatticeStencil<n>& stencil) {
        const auto offsets = lattice_offsets(n);
        for (auto& axis : stencil.axis)
            for (int a = 0; a < n; ++a)
                axis[a] = BSpline<double>(offsets[a]);
    }
};

/// The stencil of slot `slot`, whose lanes each have a point of their own.
inline PointStencil point_stencil(const double* offset_x, const double* offset_y, const double* offset_z,
                                  std::int64_t slot) {
    PointStencil stencil;
    stencil.axis[0][0] = BSpline<Lanes>(load(offset_x + slot * lane_count));
    stencil.axis[1][0] = BSpline<Lanes>(load(offset_y + slot * lane_count));
    stencil.axis[2][0] = BSpline<Lanes>(load(offset_z + slot * lane_count));
    return stencil;
}

/// Calls `work(stencil, first_entry)` for each stencil of `group`: once for a lattice group, else once a
/// slot. The stencil's points have the entries first_entry + point * lane_count + lane of the per-particle
/// arrays.
template <class Work>
void for_each_stencil(const Particles& particles, const LatticeStencils& lattices, const LaneGroup& group,
                      Work&& work) {
    if (group.on_lattice) {
        const std::int64_t first = group.first_slot * lane_count;
        switch (particles.lattice) {
        case 1:
            return work(lattices.one, first);
        case 2:
            return work(lattices.two, first);
        case 3:
            return work(lattices.three, first);
        default:
            return work(lattices.four, first);
        }
    }
    for (std::int64_t slot = 0; slot < group.slots; ++slot)
        work(point_stencil(particles.offset_x.data(), particles.offset_y.data(), particles.offset_z.data(),
                           group.first_loose + slot),
             (group.first_slot + slot) * lane_count);
}

/// Adds sum_p N_ip value_p over one group to the nodes.
inline void scatter_group(const Grid& grid, const Particles& particles, const LatticeStencils& lattices,
                          const LaneGroup& group, const Field& value, Field& field) {
    NodeSums sums;
    for_each_stencil(particles, lattices, group, [&](const auto& stencil, std::int64_t first) {
        std::array<Lanes, std::decay_t<decltype(stencil)>::points> s;
        for (std::size_t p = 0; p < s.size(); ++p)
            s[p] = load(&value[first + p * lane_count]);
        stencil.scatter_value(s, sums);
    });
    sums.add_to(field.data(), group.corner, grid.stride_y, grid.stride_z);
}

/// Least and largest value of a nodal field at the 27 nodes that the particles of each bin reach.
struct LaneRange {
    Lanes least, most;
};

inline LaneRange range_around(const Grid& grid, const Field& field, const LaneGroup& group) {
    LaneRange range{load(&field[group.corner]), load(&field[group.corner])};
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) {
                const Lanes value = load(&field[group.corner + i + j * grid.stride_y + k * grid.stride_z]);
                range.least = min(range.least, value);
                range.most = max(range.most, value);
            }
    return range;
}

} // namespace meltscope
