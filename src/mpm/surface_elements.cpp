// Heat into and temperatures of the pieces of free surface; see free_surface.hpp.

#include "meltscope/mpm/free_surface.hpp"
#include "meltscope/mpm/group_stencils.hpp"

namespace meltscope {

void deposit(const Grid& grid, const SurfaceElements& elements, std::span<const double> energy,
             Nodes& nodes) {
    Field in_layout(elements.layout.size(), 0.0);
#pragma omp parallel for schedule(static)
    for (std::size_t s = 0; s < energy.size(); ++s) {
        const std::int64_t at = elements.layout.place[s];
        in_layout[at] = energy[s] * elements.normalization[at];
    }
    // A node without mass takes its share too, which the normalization has given to the others; step 6
    // ignores it.
    for_each_block(elements.layout, [&](const LaneBlock& block) {
        for (std::int64_t g = block.first_group; g < block.last_group; ++g) {
            const LaneGroup& group = elements.layout.groups[g];
            NodeSums sums;
            bool any = false;
            for (std::int64_t slot = group.first_slot; slot < group.first_slot + group.slots; ++slot) {
                const Lanes joule = load(&in_layout[slot * lane_count]);
                if (all_of(joule == 0.0))
                    continue;
                any = true;
                point_stencil(elements.offset_x.data(), elements.offset_y.data(), elements.offset_z.data(),
                              slot)
                    .scatter_value({joule}, sums);
            }
            if (any)
                sums.add_to(nodes.increment.data(), group.corner, grid.stride_y, grid.stride_z);
        }
    });
}

void interpolate_to_surface(const Grid& grid, const SurfaceElements& elements, const Field& field,
                            std::vector<double>& interpolated) {
    Field in_layout(elements.layout.size(), 0.0);
#pragma omp parallel for schedule(static)
    for (std::size_t g = 0; g < elements.layout.groups.size(); ++g) {
        const LaneGroup& group = elements.layout.groups[g];
        for (std::int64_t slot = group.first_slot; slot < group.first_slot + group.slots; ++slot) {
            std::array<Lanes, 1> value;
            point_stencil(elements.offset_x.data(), elements.offset_y.data(), elements.offset_z.data(), slot)
                .gather(field.data() + group.corner, grid.stride_y, grid.stride_z, value);
            store(value[0] * load(&elements.normalization[slot * lane_count]), &in_layout[slot * lane_count]);
        }
    }
    interpolated.resize(elements.particle.size());
#pragma omp parallel for schedule(static)
    for (std::size_t s = 0; s < interpolated.size(); ++s)
        interpolated[s] = in_layout[elements.layout.place[s]];
}

void surface_temperatures(const Grid& grid, const SurfaceElements& elements, const Nodes& nodes,
                          std::vector<double>& temperature) {
    interpolate_to_surface(grid, elements, nodes.temperature, temperature);
}

} // namespace meltscope
