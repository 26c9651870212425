#include "meltscope/beam/radiative_exchange.hpp"

#include "level_set_rays.hpp"

#include "meltscope/constants.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

namespace meltscope {
namespace {

/// Rays start where they are this far above the surface, in cells, clear of its unevenness; grazing ones
/// sooner, at this distance.
constexpr double start_height = 0.5, start_distance = 2.0;

/// Rounds of scaling towards the row sums. They converge geometrically; what is left goes to the diagonal.
constexpr int scaling_rounds = 30;

/// Error of the radiosity after the last sweep, a bound relative to the largest.
constexpr double radiosity_error = 1e-3;

/// Patch of each element; patches are numbered in the order of block, direction and material.
struct Patches {
    std::vector<std::int32_t> of_element;
    std::vector<std::int64_t> element; ///< sorted by patch
    std::vector<std::int64_t> start;   ///< in `element`, of each patch, and the end

    std::int64_t count() const { return std::int64_t(start.size()) - 1; }
};

int nearest_axis(const Vec3& normal) {
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    return 2 * axis + (normal[axis] > 0.0);
}

Patches make_patches(const Grid& grid, const SurfaceElements& elements, const Particles& particles,
                     double patch_size) {
    using Key = std::tuple<std::int64_t, std::int64_t, std::int64_t, int, int>;
    const std::int64_t count = elements.count();
    std::vector<Key> key(count);
    for (std::int64_t s = 0; s < count; ++s) {
        const Vec3 block = (elements.point[s] - grid.origin) / (patch_size * grid.dx);
        key[s] = {std::int64_t(block[2]), std::int64_t(block[1]), std::int64_t(block[0]),
                  nearest_axis(elements.normal[s]), int(particles.material[elements.particle[s]])};
    }
    Patches patches;
    patches.element.resize(count);
    std::iota(patches.element.begin(), patches.element.end(), 0);
    std::sort(patches.element.begin(), patches.element.end(),
              [&](std::int64_t a, std::int64_t b) { return std::tie(key[a], a) < std::tie(key[b], b); });
    patches.of_element.resize(count);
    for (std::int64_t n = 0; n < count; ++n) {
        if (n == 0 || key[patches.element[n]] != key[patches.element[n - 1]])
            patches.start.push_back(n);
        patches.of_element[patches.element[n]] = std::int32_t(patches.start.size()) - 1;
    }
    patches.start.push_back(count);
    return patches;
}

/// Finds the element that a ray has met.
class ElementFinder {
  public:
    ElementFinder(const Grid& grid, const SurfaceElements& elements)
        : grid_(grid), elements_(elements), start_(grid.size + 1, 0), element_(elements.count()) {
        std::vector<std::int64_t> bin(elements.count());
        for (std::int64_t s = 0; s < elements.count(); ++s) {
            const auto node = bin_place(grid, elements.point[s]).node;
            bin[s] = grid.index(node[0], node[1], node[2]);
            ++start_[bin[s] + 1];
        }
        std::partial_sum(start_.begin(), start_.end(), start_.begin());
        std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
        for (std::int64_t s = 0; s < elements.count(); ++s)
            element_[next[bin[s]]++] = std::int32_t(s);
    }

    /// The element nearest to `point` among those that face the ray, in the 27 bins around it.
    std::optional<std::int64_t> at(const Vec3& point, const Vec3& direction) const {
        const auto node = bin_place(grid_, point.cwiseMax(grid_.origin).cwiseMin(grid_.upper_corner())).node;
        std::optional<std::int64_t> found;
        double nearest = std::numeric_limits<double>::infinity();
        for (int k = -1; k <= 1; ++k)
            for (int j = -1; j <= 1; ++j) {
                const std::int64_t first = grid_.index(node[0] - 1, node[1] + j, node[2] + k);
                for (std::int32_t n = start_[first]; n < start_[first + 3]; ++n) {
                    const std::int32_t s = element_[n];
                    const double squared = (elements_.point[s] - point).squaredNorm();
                    if (squared < nearest && elements_.normal[s].dot(direction) < 0.0) {
                        nearest = squared;
                        found = s;
                    }
                }
            }
        return found;
    }

  private:
    const Grid& grid_;
    const SurfaceElements& elements_;
    std::vector<std::int32_t> start_;   // of each bin in element_
    std::vector<std::int32_t> element_; // sorted by bin
};

/// Bits without pattern from a number (splitmix64, Steele et al. 2014).
std::uint64_t scrambled(std::uint64_t n) {
    n += 0x9e3779b97f4a7c15u;
    n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9u;
    n = (n ^ (n >> 27)) * 0x94d049bb133111ebu;
    return n ^ (n >> 31);
}

double unit_interval(std::uint64_t bits) {
    return double(bits >> 11) * 0x1p-53;
}

/// Ray r of `rays` from an element, spread by the cosine law: a rank-one lattice on the unit square, shifted
/// by the element's hash and wrapped round, mapped to the disc and lifted to the hemisphere.
Vec3 ray_direction(const Vec3& normal, std::int64_t element, int r, int rays) {
    constexpr double golden = 0.6180339887498949;
    const std::uint64_t hash = scrambled(std::uint64_t(element));
    const double a = (r + 0.5) / rays + unit_interval(hash);
    const double b = r * golden + unit_interval(scrambled(hash));
    const double radius_squared = a - std::floor(a), angle = 2.0 * constants::pi * (b - std::floor(b));
    const Vec3 helper = std::abs(normal.x()) < 0.7 ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY());
    const Vec3 u = normal.cross(helper).normalized(), v = normal.cross(u);
    const double radius = std::sqrt(radius_squared);
    return radius * (std::cos(angle) * u + std::sin(angle) * v) + std::sqrt(1.0 - radius_squared) * normal;
}

/// A_i F_ij as the rays of one end see it.
struct Entry {
    std::int32_t row, column;
    double area; ///< m^2
};

/// What the rays of one patch meet.
struct Seen {
    std::vector<Entry> entries; ///< one a patch that is seen, ascending
    double surroundings = 0.0;  ///< m^2
    double others = 0.0;        ///< m^2
    std::int64_t stray = 0;
};

Seen look_around(const Grid& grid, const FreeSurface& surface, const Patches& patches,
                 const ElementFinder& finder, std::int64_t patch, int rays) {
    const SurfaceElements& elements = surface.elements;
    Seen seen;
    std::vector<Entry> hits;
    for (std::int64_t n = patches.start[patch]; n < patches.start[patch + 1]; ++n) {
        const std::int64_t s = patches.element[n];
        const double area = elements.area[s] / rays;
        for (int r = 0; r < rays; ++r) {
            const Vec3 direction = ray_direction(elements.normal[s], s, r, rays);
            const double cosine = std::max(direction.dot(elements.normal[s]), start_height / start_distance);
            const Vec3 start = elements.point[s] + start_height / cosine * grid.dx * direction;
            const double distance = first_interface(grid, surface.phi, start, direction);
            if (!std::isfinite(distance)) {
                seen.surroundings += area;
                continue;
            }
            const auto met = finder.at(start + distance * direction, direction);
            seen.stray += !met;
            seen.others += area;
            hits.push_back({std::int32_t(patch), met ? patches.of_element[*met] : std::int32_t(patch), area});
        }
    }
    std::stable_sort(hits.begin(), hits.end(),
                     [](const Entry& a, const Entry& b) { return a.column < b.column; });
    for (const Entry& hit : hits) {
        if (seen.entries.empty() || seen.entries.back().column != hit.column)
            seen.entries.push_back({hit.row, hit.column, 0.0});
        seen.entries.back().area += hit.area;
    }
    return seen;
}

/// The mean of what both ends see, as rows; a diagonal entry in every row that sees anything.
void put_symmetric(const std::vector<Seen>& seen, RadiativeExchange& exchange) {
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        for (const Entry& e : seen[i].entries) {
            entries.push_back({e.row, e.column, 0.5 * e.area});
            entries.push_back({e.column, e.row, 0.5 * e.area});
        }
        if (!seen[i].entries.empty())
            entries.push_back({std::int32_t(i), std::int32_t(i), 0.0});
    }
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return std::tie(a.row, a.column) < std::tie(b.row, b.column);
    });
    exchange.row_start.assign(seen.size() + 1, 0);
    for (std::size_t n = 0; n < entries.size(); ++n) {
        const Entry& e = entries[n];
        if (n > 0 && e.row == entries[n - 1].row && e.column == entries[n - 1].column) {
            exchange.exchange_area.back() += e.area;
            continue;
        }
        exchange.column.push_back(e.column);
        exchange.exchange_area.push_back(e.area);
        ++exchange.row_start[e.row + 1];
    }
    std::partial_sum(exchange.row_start.begin(), exchange.row_start.end(), exchange.row_start.begin());
}

/// For each row, what its sum must be over what it is.
std::vector<double> row_factors(const RadiativeExchange& exchange, const std::vector<double>& wanted) {
    std::vector<double> factor(wanted.size(), 1.0);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        double sum = 0.0;
        for (std::int64_t n = exchange.row_start[i]; n < exchange.row_start[i + 1]; ++n)
            sum += exchange.exchange_area[n];
        if (sum > 0.0)
            factor[i] = wanted[i] / sum;
    }
    return factor;
}

/// G_ij <- G_ij scale(f_i, f_j); symmetric in, symmetric out.
template <class Scale>
void scale_symmetrically(RadiativeExchange& exchange, const std::vector<double>& factor, Scale scale) {
    for (std::size_t i = 0; i < factor.size(); ++i)
        for (std::int64_t n = exchange.row_start[i]; n < exchange.row_start[i + 1]; ++n)
            exchange.exchange_area[n] *= scale(factor[i], factor[exchange.column[n]]);
}

/// Brings the rows' sums to `wanted` and keeps the symmetry.
void close_rows(RadiativeExchange& exchange, const std::vector<double>& wanted) {
    for (int round = 0; round < scaling_rounds; ++round)
        scale_symmetrically(exchange, row_factors(exchange, wanted),
                            [](double a, double b) { return std::sqrt(a * b); });
    // No sum too large any more, and what is missing put on the diagonal.
    scale_symmetrically(exchange, row_factors(exchange, wanted), [](double a, double b) {
        return std::min({a, b, 1.0});
    });
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        double rest = wanted[i];
        std::int64_t diagonal = -1;
        for (std::int64_t n = exchange.row_start[i]; n < exchange.row_start[i + 1]; ++n) {
            if (exchange.column[n] == std::int32_t(i))
                diagonal = n;
            rest -= exchange.exchange_area[n];
        }
        if (diagonal >= 0)
            exchange.exchange_area[diagonal] += std::max(0.0, rest);
    }
}

template <class T>
std::int64_t bytes_of(const std::vector<T>& v) {
    return std::int64_t(v.size() * sizeof(T));
}

double fourth_power(double t) {
    return (t * t) * (t * t);
}

} // namespace

RadiativeExchange make_radiative_exchange(const Grid& grid, const FreeSurface& surface,
                                          const Particles& particles, const std::vector<Material>& materials,
                                          const ExchangeOptions& options) {
    if (!(options.patch_size > 0.0) || options.rays < 1)
        throw std::invalid_argument(
            "radiative exchange needs patches of some size and at least one ray an element");
    for (const Material& material : materials)
        if (!material.emissivity || !(*material.emissivity > 0.0 && *material.emissivity <= 1.0))
            throw std::invalid_argument(fmt::format(
                "material '{}' lacks an 'emissivity' above 0 and up to 1, which re-absorption needs",
                material.name));
    const auto begin = std::chrono::steady_clock::now();
    const SurfaceElements& elements = surface.elements;
    const Patches patches = make_patches(grid, elements, particles, options.patch_size);
    const ElementFinder finder(grid, elements);

    std::vector<Seen> seen(patches.count());
#pragma omp parallel for schedule(dynamic, 4)
    for (std::int64_t i = 0; i < patches.count(); ++i)
        seen[i] = look_around(grid, surface, patches, finder, i, options.rays);

    RadiativeExchange exchange;
    exchange.patch = patches.of_element;
    std::vector<double> wanted;
    double least_emissivity = 1.0;
    for (std::int64_t i = 0; i < patches.count(); ++i) {
        const std::int64_t first = patches.element[patches.start[i]];
        exchange.emissivity.push_back(*materials[particles.material[elements.particle[first]]].emissivity);
        least_emissivity = std::min(least_emissivity, exchange.emissivity.back());
        exchange.surroundings.push_back(seen[i].surroundings);
        exchange.area.push_back(seen[i].surroundings + seen[i].others);
        wanted.push_back(seen[i].others);
        exchange.cost.stray_rays += seen[i].stray;
    }
    put_symmetric(seen, exchange);
    // A patch that is seen by another through a slit its own rays have missed does not exchange with it.
    close_rows(exchange, wanted);

    // The sweeps contract the error by 1 - eps or more.
    exchange.sweeps = least_emissivity < 1.0
                          ? int(std::ceil(std::log(radiosity_error) / std::log(1.0 - least_emissivity)))
                          : 1;
    exchange.cost.patches = patches.count();
    exchange.cost.rays = elements.count() * options.rays;
    exchange.cost.factors = std::count_if(exchange.exchange_area.begin(), exchange.exchange_area.end(),
                                          [](double g) { return g > 0.0; });
    exchange.cost.bytes = bytes_of(exchange.patch) + bytes_of(exchange.area) + bytes_of(exchange.emissivity) +
                          bytes_of(exchange.surroundings) + bytes_of(exchange.row_start) +
                          bytes_of(exchange.column) + bytes_of(exchange.exchange_area);
    exchange.cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return exchange;
}

double reabsorbed_power(const RadiativeExchange& exchange, const SurfaceElements& elements,
                        std::span<const double> temperature, double ambient, std::span<double> power) {
    const std::size_t count = exchange.area.size();
    std::vector<double> black(count, 0.0); // sigma (T^4 - T_amb^4), mean over the patch, W/m^2
    for (std::int64_t s = 0; s < elements.count(); ++s)
        black[exchange.patch[s]] += elements.area[s] * (fourth_power(temperature[s]) - fourth_power(ambient));
    for (std::size_t i = 0; i < count; ++i)
        black[i] *= constants::stefan_boltzmann / exchange.area[i];

    if (std::all_of(black.begin(), black.end(), [](double flux) { return flux == 0.0; }))
        return 0.0;

    std::vector<double> radiosity = black; // beyond that at ambient, W/m^2
    const auto irradiation = [&](std::size_t i) {
        double sum = 0.0;
        for (std::int64_t n = exchange.row_start[i]; n < exchange.row_start[i + 1]; ++n)
            sum += exchange.exchange_area[n] * radiosity[exchange.column[n]];
        return sum / exchange.area[i];
    };
    double largest = 0.0, least_emissivity = 1.0;
    for (std::size_t i = 0; i < count; ++i) {
        largest = std::max(largest, std::abs(black[i]));
        least_emissivity = std::min(least_emissivity, exchange.emissivity[i]);
    }
    // A sweep contracts the error by 1 - eps, so that after a change d it is at most d (1 - eps)/eps.
    const double small_change =
        radiosity_error * largest * least_emissivity / std::max(1.0 - least_emissivity, 1e-12);
    double change = 2.0 * small_change;
    for (int sweep = 0; sweep < exchange.sweeps && change > small_change; ++sweep) {
        change = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
            const double emissivity = exchange.emissivity[i];
            if (emissivity == 1.0)
                continue;
            const double next = emissivity * black[i] + (1.0 - emissivity) * irradiation(i);
            change = std::max(change, std::abs(next - radiosity[i]));
            radiosity[i] = next;
        }
    }

    std::vector<double> absorbed(count); // W/m^2
    for (std::size_t i = 0; i < count; ++i)
        absorbed[i] = exchange.emissivity[i] * irradiation(i);
    double sum = 0.0;
    for (std::int64_t s = 0; s < elements.count(); ++s) {
        const double watt = absorbed[exchange.patch[s]] * elements.area[s];
        power[s] += watt;
        sum += watt;
    }
    return sum;
}

} // namespace meltscope
