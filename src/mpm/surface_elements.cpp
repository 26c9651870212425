// Heat into and temperatures of the pieces of free surface; see free_surface.hpp.

#include "meltscope/mpm/free_surface.hpp"
#include "meltscope/mpm/group_stencils.hpp"

#include <algorithm>
#include <memory>

namespace meltscope {
namespace {

/// Where less than this share of the elements is heated, one thread that goes from one to the next is done
/// sooner than all that look at every element.
constexpr double few = 1.0 / 32.0;

/// Storage index of node (-1,-1,-1) of the bin of an entry of the layout.
std::int64_t corner_of(const LaneLayout& layout, std::int64_t entry) {
    const std::int64_t slot = entry / lane_count;
    const auto group =
        std::prev(std::upper_bound(layout.groups.begin(), layout.groups.end(), slot,
                                   [](std::int64_t s, const LaneGroup& g) { return s < g.first_slot; }));
    return group->corner + entry % lane_count;
}

/// An array in the layout's order, zero throughout; threads share what takes as long as half of a deposit.
std::unique_ptr<double[]> zeros_in_layout(const LaneLayout& layout) {
    auto zeros = std::make_unique_for_overwrite<double[]>(layout.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t at = 0; at < layout.size(); ++at)
        zeros[at] = 0.0;
    return zeros;
}

/// D_i += energy N_i(x_s), energy in the layout's order and normalized. A node without mass takes its share
/// too, which the normalization has given to the others; step 6 ignores it.
void deposit_normalized(const Grid& grid, const SurfaceElements& elements, const double* energy,
                        Nodes& nodes) {
    for_each_block(elements.layout, [&](const LaneBlock& block) {
        for (std::int64_t g = block.first_group; g < block.last_group; ++g) {
            const LaneGroup& group = elements.layout.groups[g];
            NodeSums sums;
            bool any = false;
            for (std::int64_t slot = group.first_slot; slot < group.first_slot + group.slots; ++slot) {
                const Lanes joule = load(&energy[slot * lane_count]);
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

} // namespace

void deposit(const Grid& grid, const SurfaceElements& elements, std::span<const double> energy,
             Nodes& nodes) {
    const auto in_layout = zeros_in_layout(elements.layout);
#pragma omp parallel for schedule(static)
    for (std::size_t s = 0; s < energy.size(); ++s) {
        const std::int64_t at = elements.layout.place[s];
        in_layout[at] = energy[s] * elements.normalization[at];
    }
    deposit_normalized(grid, elements, in_layout.get(), nodes);
}

void deposit(const Grid& grid, const SurfaceElements& elements, const ElementHeat& energy, Nodes& nodes) {
    if (double(energy.element.size()) > few * double(elements.count())) {
        const auto in_layout = zeros_in_layout(elements.layout);
#pragma omp parallel for schedule(static)
        for (std::size_t n = 0; n < energy.element.size(); ++n) {
            const std::int64_t at = elements.layout.place[energy.element[n]];
            in_layout[at] = energy.amount[n] * elements.normalization[at];
        }
        return deposit_normalized(grid, elements, in_layout.get(), nodes);
    }
    for (std::size_t n = 0; n < energy.element.size(); ++n) {
        const std::int64_t at = elements.layout.place[energy.element[n]];
        const BSpline<double> x(elements.offset_x[at]), y(elements.offset_y[at]), z(elements.offset_z[at]);
        const double joule = energy.amount[n] * elements.normalization[at];
        double* first = &nodes.increment[corner_of(elements.layout, at)];
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i)
                    first[i + j * grid.stride_y + k * grid.stride_z] +=
                        joule * x.value[i] * y.value[j] * z.value[k];
    }
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
