#include "meltscope/build/powder.hpp"

#include "balls_in_box.hpp"

#include "meltscope/constants.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <utility>

namespace meltscope {

namespace {

constexpr double allowed_overlap = 0.01; // of the smaller diameter

/// Numbers that are the same with every standard library; the distributions of <random> are not.
class Random {
  public:
    explicit Random(std::uint64_t seed) : generator_(seed) {}

    /// Evenly from [0, 1).
    double uniform() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }

    /// Fisher and Yates.
    void shuffle(std::vector<double>& values) {
        for (std::size_t left = values.size(); left > 1; --left) {
            const auto pick = static_cast<std::size_t>(uniform() * static_cast<double>(left));
            std::swap(values[left - 1], values[std::min(pick, left - 1)]);
        }
    }

  private:
    std::mt19937_64 generator_;
};

/// The z below which a standard normal variable lies with the given probability.
double normal_quantile(double probability) {
    double low = -9.0;
    double high = 9.0;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (0.5 * std::erfc(-middle / std::sqrt(2.0)) < probability ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// Diameters in rising order and the share of balls up to and with each.
struct SizeTable {
    std::vector<double> diameter;
    std::vector<double> share;
};

SizeTable make_size_table(const PowderSpec& spec) {
    constexpr int entries = 8192;
    const double tenth = normal_quantile(0.9);
    const double width_below = std::log(spec.d50 / spec.d10) / tenth;
    const double width_above = std::log(spec.d90 / spec.d50) / tenth;
    const double coarsest = (spec.box.max - spec.box.min).minCoeff();
    SizeTable table;
    double sum = 0.0;
    for (int i = 0; i < entries; ++i) {
        const double probability = std::clamp((i + 0.5) / entries, 0.01, 0.99);
        const double z = normal_quantile(probability);
        const double diameter =
            std::min(coarsest, spec.d50 * std::exp(z * (z < 0.0 ? width_below : width_above)));
        const double relative = diameter / spec.d50;
        // Equal volumes of finer balls are more balls.
        sum += spec.basis == PercentileBasis::volume ? 1.0 / (relative * relative * relative) : 1.0;
        table.diameter.push_back(diameter);
        table.share.push_back(sum);
    }
    for (double& share : table.share) {
        share /= sum;
    }
    return table;
}

double mean_ball_volume(const SizeTable& table) {
    double mean = 0.0;
    double before = 0.0;
    for (std::size_t i = 0; i < table.diameter.size(); ++i) {
        const double d = table.diameter[i];
        mean += (table.share[i] - before) * constants::pi / 6.0 * d * d * d;
        before = table.share[i];
    }
    return mean;
}

void check_sizes(const PowderSpec& spec) {
    if (!(std::isfinite(spec.d90) && spec.d10 > 0.0 && spec.d10 <= spec.d50 && spec.d50 <= spec.d90)) {
        throw GeometryError(fmt::format("powder needs 0 < d10 <= d50 <= d90, not {}, {} and {} m", spec.d10,
                                        spec.d50, spec.d90));
    }
    const double thinnest = (spec.box.max - spec.box.min).minCoeff();
    if (spec.d90 > thinnest) {
        throw GeometryError(
            fmt::format("powder of d90 {:.4g} m does not fit into its box, {:.4g} m at its thinnest",
                        spec.d90, thinnest));
    }
}

std::vector<double> draw_from(const SizeTable& table, std::size_t count, Random& random) {
    std::vector<double> diameters;
    for (std::size_t i = 0; i < count; ++i) {
        const double share = (static_cast<double>(i) + random.uniform()) / static_cast<double>(count);
        const auto found = std::upper_bound(table.share.begin(), table.share.end(), share);
        const auto index = static_cast<std::size_t>(found - table.share.begin());
        diameters.push_back(table.diameter[std::min(index, table.diameter.size() - 1)]);
    }
    random.shuffle(diameters);
    return diameters;
}

bool is_solid(const PowderGround& ground, const Vec3& place) {
    if (ground.distance && ground.distance(place) < 0.0) {
        return true;
    }
    return std::any_of(ground.balls.begin(), ground.balls.end(), [&](const Ball& ball) {
        return (place - ball.center).squaredNorm() < ball.radius * ball.radius;
    });
}

/// Volume of the box that is not solid, by samples an eighth of d50 apart (a hundred along each side at
/// most).
double free_volume(const PowderSpec& spec, const PowderGround& ground) {
    const Vec3 size = spec.box.max - spec.box.min;
    if (!ground.distance && ground.balls.empty()) {
        return size.prod();
    }
    const Index3 count = (size.array() / (0.125 * spec.d50)).ceil().max(1.0).min(100.0).cast<std::int64_t>();
    const Vec3 spacing = size.array() / count.cast<double>();
    std::int64_t found = 0;
    for (std::int64_t k = 0; k < count.z(); ++k) {
        for (std::int64_t j = 0; j < count.y(); ++j) {
            for (std::int64_t i = 0; i < count.x(); ++i) {
                const Eigen::Array3d cell(static_cast<double>(i), static_cast<double>(j),
                                          static_cast<double>(k));
                const Vec3 place = spec.box.min.array() + (cell + 0.5) * spacing.array();
                found += is_solid(ground, place) ? 0 : 1;
            }
        }
    }
    return size.prod() * static_cast<double>(found) / static_cast<double>(count.prod());
}

/// Fixed balls that a ball in the box can touch, in the units of the bed.
std::vector<Ball> fixed_balls(const PowderSpec& spec, const PowderGround& ground) {
    std::vector<Ball> near;
    for (const Ball& ball : ground.balls) {
        const Vec3 nearest = ball.center.cwiseMax(spec.box.min).cwiseMin(spec.box.max);
        if ((nearest - ball.center).norm() < ball.radius) {
            near.push_back({(ball.center - spec.box.min) / spec.d50, ball.radius / spec.d50});
        }
    }
    return near;
}

/// A random place in the box for a ball of the given radius, clear of what is solid; where a thousand places
/// are not, the best of them.
Vec3 random_place(const BallsInBox& bed, double radius, Random& random) {
    Vec3 best = 0.5 * bed.size;
    double best_gap = -HUGE_VAL;
    for (int attempt = 0; attempt < 1000 && best_gap < 0.0; ++attempt) {
        Vec3 place;
        for (int axis = 0; axis < 3; ++axis) {
            place[axis] = radius + random.uniform() * (bed.size[axis] - 2.0 * radius);
        }
        double gap = bed.distance ? bed.distance(place) - radius : HUGE_VAL;
        for (const Ball& ball : bed.fixed) {
            gap = std::min(gap, (place - ball.center).norm() - ball.radius - radius);
        }
        if (gap > best_gap) {
            best_gap = gap;
            best = place;
        }
    }
    return best;
}

/// Packs to the given share of the free volume; none if the balls do not come to rest without overlap.
std::optional<std::vector<Ball>> try_packing(const PowderSpec& spec, const PowderGround& ground, double free,
                                             double packing) {
    const SizeTable table = make_size_table(spec);
    const double wanted = packing * free;
    const auto count = static_cast<std::size_t>(std::max(1.0, std::round(wanted / mean_ball_volume(table))));
    Random random(spec.seed);
    std::vector<double> diameters = draw_from(table, count, random);
    double drawn = 0.0;
    for (const double d : diameters) {
        drawn += constants::pi / 6.0 * d * d * d;
    }
    const double scale = std::cbrt(wanted / drawn); // near one; makes the packing exact

    BallsInBox bed;
    bed.size = (spec.box.max - spec.box.min) / spec.d50;
    bed.fixed = fixed_balls(spec, ground);
    if (ground.distance) {
        bed.distance = [&](const Vec3& place) {
            return ground.distance(spec.box.min + spec.d50 * place) / spec.d50;
        };
    }
    for (const double d : diameters) {
        const double radius = 0.5 * std::min(scale * d / spec.d50, bed.size.minCoeff());
        bed.center.push_back(random_place(bed, radius, random));
        bed.radius.push_back(radius);
    }
    if (!part_balls(bed, 0.5 * allowed_overlap)) {
        return std::nullopt;
    }
    settle_balls(bed);
    if (largest_overlap(bed) > allowed_overlap) {
        return std::nullopt;
    }
    std::vector<Ball> balls;
    for (std::size_t i = 0; i < count; ++i) {
        balls.push_back({spec.box.min + spec.d50 * bed.center[i], spec.d50 * bed.radius[i]});
    }
    return balls;
}

} // namespace

std::vector<double> draw_diameters(const PowderSpec& spec, std::size_t count) {
    check_sizes(spec);
    Random random(spec.seed);
    return draw_from(make_size_table(spec), count, random);
}

std::vector<Ball> pack_powder(const PowderSpec& spec, const PowderGround& ground) {
    check_shape(spec.box);
    check_sizes(spec);
    if (!(spec.packing > 0.0 && spec.packing < 1.0)) {
        throw GeometryError(
            fmt::format("the packing of powder must lie between 0 and 1, not {}", spec.packing));
    }
    const double free = free_volume(spec, ground);
    constexpr double most_balls = 1e6;
    const double balls_needed = spec.packing * free / mean_ball_volume(make_size_table(spec));
    if (!(balls_needed >= 0.5 && balls_needed <= most_balls)) {
        throw GeometryError(fmt::format("the powder would take {:.3g} balls; from 1 to {:.0g} are possible",
                                        balls_needed, most_balls));
    }
    if (auto balls = try_packing(spec, ground, free, spec.packing)) {
        return std::move(*balls);
    }
    // In thousandths, so that the packing named is one that has been made.
    int reachable = 0;
    for (int refused = static_cast<int>(std::ceil(1000.0 * spec.packing)); refused - reachable > 1;) {
        const int middle = (reachable + refused) / 2;
        (try_packing(spec, ground, free, middle / 1000.0) ? reachable : refused) = middle;
    }
    throw GeometryError(
        fmt::format("powder cannot be packed to {:.3g} of the box's volume; {:.3f} can be reached",
                    spec.packing, reachable / 1000.0));
}

} // namespace meltscope
