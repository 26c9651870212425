#include "meltscope/build/fill.hpp"

#include "mesh_section.hpp"
#include "row_interval.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope {

namespace {

/// Sites are asked for at their place plus this many spacings.
constexpr double nudge = 1e-9;

double site_place(const Lattice& lattice, int axis, std::int64_t index) {
    return lattice.origin[axis] + (static_cast<double>(index) + nudge) * lattice.spacing;
}

/// The first site at or above a place.
std::int64_t first_site(const Lattice& lattice, int axis, double place) {
    const double index = std::ceil((place - lattice.origin[axis]) / lattice.spacing - nudge);
    return static_cast<std::int64_t>(std::clamp(index, 0.0, static_cast<double>(lattice.count[axis])));
}

/// Sites [begin, end) from the first at or above `low` to the last below `high`.
struct SiteRange {
    std::int64_t begin = 0;
    std::int64_t end = 0;
};

SiteRange sites_between(const Lattice& lattice, int axis, double low, double high) {
    return {first_site(lattice, axis, low), first_site(lattice, axis, high)};
}

/// One more on either side, for searches that must not miss what rounding moves over a site.
SiteRange widened(SiteRange range, std::int64_t count) {
    return {std::max<std::int64_t>(range.begin - 1, 0), std::min(range.end + 1, count)};
}

/// Sets the sites of one row that lie in a stretch.
void set_row(const Lattice& lattice, const RowInterval& interval, std::span<std::int16_t> row,
             std::int16_t body) {
    if (!(interval.begin < interval.end)) {
        return;
    }
    const SiteRange sites = sites_between(lattice, 0, interval.begin, interval.end);
    if (sites.begin < sites.end) {
        std::fill(row.begin() + sites.begin, row.begin() + sites.end, body);
    }
}

std::span<std::int16_t> row_of(const Lattice& lattice, std::span<std::int16_t> sites, std::int64_t j) {
    const auto length = static_cast<std::size_t>(lattice.count.x());
    return sites.subspan(static_cast<std::size_t>(j) * length, length);
}

/// Writes a body of one convex piece into layer k.
template <class Convex>
void set_layer(const Lattice& lattice, const Convex& shape, std::int64_t k, std::span<std::int16_t> sites,
               std::int16_t body) {
    const Box box = bounding_box(shape);
    const double z = site_place(lattice, 2, k);
    const SiteRange rows = widened(sites_between(lattice, 1, box.min.y(), box.max.y()), lattice.count.y());
    for (std::int64_t j = rows.begin; j < rows.end; ++j) {
        set_row(lattice, row_interval(shape, site_place(lattice, 1, j), z), row_of(lattice, sites, j), body);
    }
}

void set_layer(const Lattice& lattice, const Solid& solid, std::span<const std::uint32_t> triangles,
               std::int64_t k, std::span<std::int16_t> sites, std::int16_t body) {
    const std::vector<SectionEdge> section = cut_mesh(solid, triangles, site_place(lattice, 2, k));
    // Edges by row, so that a row looks at its own edges only.
    std::vector<std::vector<SectionEdge>> by_row(static_cast<std::size_t>(lattice.count.y()));
    for (const SectionEdge& edge : section) {
        const auto [low, high] = std::minmax(edge.begin.y(), edge.end.y());
        const SiteRange rows = widened(sites_between(lattice, 1, low, high), lattice.count.y());
        for (std::int64_t j = rows.begin; j < rows.end; ++j) {
            by_row[static_cast<std::size_t>(j)].push_back(edge);
        }
    }
    std::vector<MeshCrossing> crossings;
    for (std::int64_t j = 0; j < lattice.count.y(); ++j) {
        const std::vector<SectionEdge>& edges = by_row[static_cast<std::size_t>(j)];
        for (const RowInterval& interval : row_intervals(edges, site_place(lattice, 1, j), crossings)) {
            set_row(lattice, interval, row_of(lattice, sites, j), body);
        }
    }
}

std::vector<SiteRange> layers_of_pieces(const Shape& shape, const Lattice& lattice) {
    std::vector<SiteRange> layers;
    const auto add = [&](double low, double high) {
        layers.push_back(widened(sites_between(lattice, 2, low, high), lattice.count.z()));
    };
    if (const auto* balls = std::get_if<Balls>(&shape)) {
        for (const Ball& ball : balls->balls) {
            add(ball.center.z() - ball.radius, ball.center.z() + ball.radius);
        }
    } else if (const auto* solid = std::get_if<Solid>(&shape)) {
        for (const auto& [a, b, c] : solid->triangles) {
            const auto [low, high] =
                std::minmax({solid->points[a].z(), solid->points[b].z(), solid->points[c].z()});
            add(low, high);
        }
    }
    return layers;
}

} // namespace

LatticeFill::LatticeFill(std::span<const Shape> bodies, const Lattice& lattice)
    : bodies_(bodies), lattice_(lattice), buckets_(bodies.size()) {
    constexpr std::size_t most = std::numeric_limits<std::int16_t>::max();
    if (bodies.size() > most) {
        throw GeometryError(
            fmt::format("there are {} bodies; no more than {} are possible", bodies.size(), most));
    }
    if (!(std::isfinite(lattice.spacing) && lattice.spacing > 0.0) || (lattice.count < 0).any()) {
        throw GeometryError("a lattice needs a spacing above zero and counts that are not negative");
    }
    for (std::size_t body = 0; body < bodies.size(); ++body) {
        check_shape(bodies[body]);
        const std::vector<SiteRange> layers = layers_of_pieces(bodies[body], lattice);
        if (layers.empty()) {
            continue;
        }
        Buckets& buckets = buckets_[body];
        buckets.first.assign(static_cast<std::size_t>(lattice.count.z()) + 1, 0);
        for (const SiteRange& range : layers) {
            for (std::int64_t k = range.begin; k < range.end; ++k) {
                ++buckets.first[static_cast<std::size_t>(k) + 1];
            }
        }
        for (std::size_t k = 1; k < buckets.first.size(); ++k) {
            buckets.first[k] += buckets.first[k - 1];
        }
        buckets.items.resize(buckets.first.back());
        std::vector<std::size_t> next(buckets.first.begin(), buckets.first.end() - 1);
        for (std::size_t item = 0; item < layers.size(); ++item) {
            for (std::int64_t k = layers[item].begin; k < layers[item].end; ++k) {
                buckets.items[next[static_cast<std::size_t>(k)]++] = static_cast<std::uint32_t>(item);
            }
        }
    }
}

void LatticeFill::layer(std::int64_t k, std::span<std::int16_t> sites) const {
    std::fill(sites.begin(), sites.end(), std::int16_t{-1});
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        const auto index = static_cast<std::int16_t>(body);
        const Buckets& buckets = buckets_[body];
        std::span<const std::uint32_t> pieces;
        if (!buckets.first.empty()) {
            const std::size_t first = buckets.first[static_cast<std::size_t>(k)];
            pieces = std::span(buckets.items)
                         .subspan(first, buckets.first[static_cast<std::size_t>(k) + 1] - first);
        }
        std::visit(
            [&](const auto& shape) {
                using Type = std::decay_t<decltype(shape)>;
                if constexpr (std::is_same_v<Type, Balls>) {
                    for (const std::uint32_t ball : pieces) {
                        set_layer(lattice_, shape.balls[ball], k, sites, index);
                    }
                } else if constexpr (std::is_same_v<Type, Solid>) {
                    set_layer(lattice_, shape, pieces, k, sites, index);
                } else {
                    set_layer(lattice_, shape, k, sites, index);
                }
            },
            bodies_[body]);
    }
}

std::vector<std::int16_t> fill(std::span<const Shape> bodies, const Lattice& lattice) {
    const LatticeFill filler(bodies, lattice);
    const auto layer_size = static_cast<std::size_t>(lattice.count.x() * lattice.count.y());
    std::vector<std::int16_t> sites(layer_size * static_cast<std::size_t>(lattice.count.z()));
#pragma omp parallel for schedule(dynamic)
    for (std::int64_t k = 0; k < lattice.count.z(); ++k) {
        filler.layer(k, std::span(sites).subspan(static_cast<std::size_t>(k) * layer_size, layer_size));
    }
    return sites;
}

} // namespace meltscope
