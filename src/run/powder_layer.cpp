#include "meltscope/run/powder_layer.hpp"

#include "meltscope/build/fill.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace meltscope {
namespace {

/// The material as seen from above: what lies below the highest particle of a column of lattice sites counts
/// as solid, pores included.
struct Relief {
    Lattice lattice;
    std::vector<std::int64_t> filled; ///< sites up to the column's top; x fastest
    std::vector<double> height;       ///< m, of the column's top

    double lower_edge(int axis, std::int64_t site) const {
        return lattice.origin[axis] + (double(site) - 0.5) * lattice.spacing;
    }
    std::int64_t column(std::int64_t i, std::int64_t j) const { return i + lattice.count[0] * j; }
    double height_of(std::int64_t i, std::int64_t j) const { return height[column(i, j)]; }
    /// The site at a place, or the nearest.
    std::int64_t site_of(int axis, double place) const {
        const double site = std::floor((place - lower_edge(axis, 0)) / lattice.spacing);
        return std::clamp<std::int64_t>(std::int64_t(site), 0, lattice.count[axis] - 1);
    }
};

Relief relief_of(const Simulation& s) {
    Relief relief;
    relief.lattice.spacing = s.grid.dx / s.particles.lattice;
    relief.lattice.origin = s.grid.origin + Vec3::Constant(0.5 * relief.lattice.spacing);
    relief.lattice.count = s.grid.cells * s.particles.lattice;
    relief.filled.assign(relief.lattice.count[0] * relief.lattice.count[1], 0);
    for (const Vec3& x : s.particles.position) {
        std::int64_t& top = relief.filled[relief.column(relief.site_of(0, x[0]), relief.site_of(1, x[1]))];
        top = std::max(top, relief.site_of(2, x[2]) + 1);
    }
    for (const std::int64_t filled : relief.filled)
        relief.height.push_back(relief.lower_edge(2, filled));
    return relief;
}

/// Heights as a ball of that radius feels them that rolls over the relief: pores that it does not enter are
/// closed. `sign` 1: of its centre, from the heights (a dilation); -1: of what it touches, from the centre's
/// (an erosion).
std::vector<double> rolled(const Relief& relief, const std::vector<double>& from, double radius,
                           double sign) {
    const double spacing = relief.lattice.spacing;
    const auto reach = std::int64_t(radius / spacing);
    const Index3& count = relief.lattice.count;
    std::vector<double> result(from.size());
#pragma omp parallel for schedule(static)
    for (std::int64_t j = 0; j < count[1]; ++j)
        for (std::int64_t i = 0; i < count[0]; ++i) {
            double most = -HUGE_VAL;
            for (std::int64_t v = std::max<std::int64_t>(j - reach, 0);
                 v <= std::min(j + reach, count[1] - 1); ++v)
                for (std::int64_t u = std::max<std::int64_t>(i - reach, 0);
                     u <= std::min(i + reach, count[0] - 1); ++u) {
                    const double across = spacing * spacing * double((u - i) * (u - i) + (v - j) * (v - j));
                    if (across <= radius * radius)
                        most = std::max(most, sign * from[relief.column(u, v)] +
                                                  std::sqrt(radius * radius - across));
                }
            result[relief.column(i, j)] = sign * most;
        }
    return result;
}

/// The relief without the pores into which a ball of that radius cannot fall.
Relief closed(Relief relief, double radius) {
    const std::vector<double> center = rolled(relief, relief.height, radius, 1.0);
    relief.height = rolled(relief, center, radius, -1.0);
    return relief;
}

/// Distance of a point from the relief's surface, negative below, at most `reach`; the columns are square
/// prisms without a lower end.
double distance_to(const Relief& relief, const Vec3& point, double reach) {
    const double spacing = relief.lattice.spacing;
    const std::int64_t home_i = relief.site_of(0, point[0]), home_j = relief.site_of(1, point[1]);
    const bool outside = point[2] >= relief.height_of(home_i, home_j);
    double nearest = std::min(reach, std::abs(point[2] - relief.height_of(home_i, home_j)));
    const auto gap = [&](int axis, std::int64_t site) {
        const double low = relief.lower_edge(axis, site);
        return std::max({0.0, low - point[axis], point[axis] - (low + spacing)});
    };
    // Ring by ring, as long as a ring can be nearer than what was found.
    for (std::int64_t ring = 1; double(ring - 1) * spacing < nearest; ++ring) {
        const std::int64_t j_low = std::max<std::int64_t>(home_j - ring, 0);
        const std::int64_t j_high = std::min(home_j + ring, relief.lattice.count[1] - 1);
        for (std::int64_t j = j_low; j <= j_high; ++j) {
            const bool whole_row = j == home_j - ring || j == home_j + ring;
            const double gap_y = gap(1, j);
            for (std::int64_t i = home_i - ring; i <= home_i + ring; i += whole_row ? 1 : 2 * ring) {
                if (i < 0 || i >= relief.lattice.count[0])
                    continue;
                const double rise =
                    outside ? point[2] - relief.height_of(i, j) : relief.height_of(i, j) - point[2];
                const double gap_z = std::max(0.0, rise);
                const double gap_x = gap(0, i);
                nearest = std::min(nearest, std::sqrt(gap_x * gap_x + gap_y * gap_y + gap_z * gap_z));
            }
        }
    }
    return outside ? nearest : -nearest;
}

std::vector<Ball> balls_of_layer(const Relief& bare, const PowderLayer& layer, const Box& space) {
    const Relief relief = closed(bare, 0.5 * layer.d50);
    PowderSpec spec;
    spec.box = space;
    spec.d10 = layer.d10;
    spec.d50 = layer.d50;
    spec.d90 = layer.d90;
    spec.packing = layer.packing;
    spec.seed = layer.seed;
    spec.basis = layer.basis;
    // No ball has a larger radius: the 99 % quantile is d50 (d90/d50)^1.82 at most, or the thinnest side.
    const double reach = std::min(layer.d90 * layer.d90 / layer.d50, (space.max - space.min).minCoeff());
    PowderGround ground;
    ground.distance = [&](const Vec3& point) { return distance_to(relief, point, reach); };
    return pack_powder(spec, ground);
}

void check_layer(const Simulation& s, const PowderLayer& layer) {
    if (s.particles.lattice == 0)
        throw std::invalid_argument("a layer needs particles that sit on a lattice");
    if (layer.material < 0 || std::size_t(layer.material) >= s.eos.size())
        throw std::invalid_argument(
            fmt::format("the layer is of material {}, the run has {}", layer.material, s.eos.size()));
    if (layer.homogenised && !s.eos[layer.material].powder_conductivity)
        throw std::invalid_argument(fmt::format("{}: homogenised powder needs conductivity.powder",
                                                s.parameters.materials[layer.material].name));
    if (!(layer.thickness > 0.0 && layer.packing > 0.0 && layer.packing < 1.0 && layer.temperature > 0.0))
        throw std::invalid_argument(fmt::format(
            "a layer needs a thickness and a temperature above zero and a packing between 0 and 1, not "
            "{:g} m, {:g} K and {:g}",
            layer.thickness, layer.temperature, layer.packing));
}

/// `what` is the layer that would end at height `top`, m.
void require_room(const Simulation& s, double top, const std::string& what) {
    const double end = s.grid.upper_corner()[2];
    if (top > end + 1e-6 * s.grid.dx)
        throw GeometryError(fmt::format(
            "{} does not fit: its top would be at z = {:g} m and the domain ends at {:g} m; take a "
            "higher domain.max or a smaller layer.thickness",
            what, top, end));
}

std::vector<ScheduledLayer> in_order(std::vector<ScheduledLayer> layers) {
    std::stable_sort(layers.begin(), layers.end(),
                     [](const ScheduledLayer& a, const ScheduledLayer& b) { return a.time < b.time; });
    return layers;
}

} // namespace

std::int64_t add_layer(Simulation& s, const PowderLayer& layer) {
    check_layer(s, layer);
    const Relief relief = relief_of(s);
    const Lattice& lattice = relief.lattice;
    const auto [lowest, highest] = std::minmax_element(relief.filled.begin(), relief.filled.end());
    Box space{s.grid.origin, s.grid.upper_corner()};
    space.min[2] = relief.lower_edge(2, *lowest);
    const double top = relief.lower_edge(2, *highest) + layer.thickness;
    require_room(s, top, "the layer");
    space.max[2] = top;

    const std::vector<Shape> shapes{layer.homogenised ? Shape(space)
                                                      : Shape(Balls{balls_of_layer(relief, layer, space)})};
    const LatticeFill filling(shapes, lattice);
    const double volume = std::pow(lattice.spacing, 3);
    const double density = s.eos[layer.material].density * (layer.homogenised ? layer.packing : 1.0);
    const double energy = s.eos[layer.material].energy(layer.temperature);
    std::int64_t id = s.particles.count() == 0 ? 0 : s.particles.id_of(s.particles.count() - 1) + 1;
    ParticleList list;
    std::vector<std::int16_t> sites(lattice.count[0] * lattice.count[1]);
    for (std::int64_t k = *lowest; k < lattice.count[2] && relief.lower_edge(2, k) < top; ++k) {
        filling.layer(k, sites);
        for (std::int64_t j = 0; j < lattice.count[1]; ++j)
            for (std::int64_t i = 0; i < lattice.count[0]; ++i) {
                const std::int64_t column = relief.column(i, j);
                if (sites[column] < 0 || k < relief.filled[column])
                    continue;
                list.position.push_back(lattice.origin +
                                        lattice.spacing * Vec3(double(i), double(j), double(k)));
                list.volume.push_back(volume);
                list.mass.push_back(volume * density);
                list.specific_energy.push_back(energy);
                list.id.push_back(id++);
                list.material.push_back(layer.material);
            }
    }
    if (list.size() == 0)
        throw GeometryError(fmt::format("a layer of {:g} m holds no lattice point; they lie {:g} m apart",
                                        layer.thickness, lattice.spacing));
    if (layer.homogenised)
        list.powder.assign(list.id.size(), 1);
    add_particles(s, list);
    return list.size();
}

void require_room_for_layers(const Simulation& s, std::vector<ScheduledLayer> layers, std::int64_t laid) {
    if (std::size_t(laid) >= layers.size())
        return;
    layers = in_order(std::move(layers));
    const Relief relief = relief_of(s);
    std::int64_t highest = *std::max_element(relief.filled.begin(), relief.filled.end());
    for (std::size_t n = std::size_t(laid); n < layers.size(); ++n) {
        const PowderLayer& layer = layers[n].layer;
        check_layer(s, layer);
        const double top = relief.lower_edge(2, highest) + layer.thickness;
        require_room(s, top, fmt::format("the layer of t = {:g} s", layers[n].time));
        // Homogenised powder fills the layer; how high balls come is known when they have settled.
        if (layer.homogenised)
            highest = std::max(highest, std::int64_t(std::floor(
                                            (top - relief.lower_edge(2, 0)) / relief.lattice.spacing + 0.5)));
    }
}

CommandSource scheduled_layers(std::vector<ScheduledLayer> layers) {
    layers = in_order(std::move(layers));
    const auto next = [layers](const Run& run) {
        return std::size_t(run.layers_laid) < layers.size() ? layers[run.layers_laid].time : never;
    };
    const auto apply = [layers, next](Run& run) {
        const double now = run.simulation.time;
        while (std::size_t(run.layers_laid) < layers.size() &&
               (next(run) <= now || same_instant(next(run), now))) {
            add_layer(run.simulation, layers[run.layers_laid].layer);
            ++run.layers_laid;
        }
    };
    return {apply, next};
}

} // namespace meltscope
