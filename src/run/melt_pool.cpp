#include "meltscope/run/measure.hpp"

#include <algorithm>
#include <limits>

namespace meltscope {
namespace {

/// Points tried a cell along each axis where an isotherm or the surface cuts the cell.
constexpr int volume_samples = 4;

/// The box of the hot region along three directions.
struct Extent {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;

    void take(const Vec3& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    void take(const Extent& e) {
        low = low.cwiseMin(e.low);
        high = high.cwiseMax(e.high);
    }
};

/// Along an edge, r from 0 to 1, the stretch that is hot (T > isotherm) and inside (phi < 0).
struct Stretch {
    double first = 0.0, last = 1.0;

    void cut(double at_0, double at_1) { // keep where a linear function is positive
        if (at_0 <= 0.0 && at_1 <= 0.0)
            first = 1.0, last = 0.0;
        else if (at_0 <= 0.0)
            first = std::max(first, at_0 / (at_0 - at_1));
        else if (at_1 <= 0.0)
            last = std::min(last, at_0 / (at_0 - at_1));
    }
    bool empty() const { return first > last; }
};

/// Volume in a cell of the region hot and inside, corner values x fastest.
double cell_volume(const std::array<double, 8>& hot, const std::array<double, 8>& inside) {
    const auto positive = [](double v) { return v > 0.0; };
    if (std::all_of(hot.begin(), hot.end(), positive) && std::all_of(inside.begin(), inside.end(), positive))
        return 1.0;
    if (std::none_of(hot.begin(), hot.end(), positive) ||
        std::none_of(inside.begin(), inside.end(), positive))
        return 0.0;
    const auto trilinear = [](const std::array<double, 8>& f, double x, double y, double z) {
        const auto mix = [](double a, double b, double r) { return a + r * (b - a); };
        return mix(mix(mix(f[0], f[1], x), mix(f[2], f[3], x), y),
                   mix(mix(f[4], f[5], x), mix(f[6], f[7], x), y), z);
    };
    int count = 0;
    for (int c = 0; c < volume_samples; ++c)
        for (int b = 0; b < volume_samples; ++b)
            for (int a = 0; a < volume_samples; ++a) {
                const double x = (a + 0.5) / volume_samples, y = (b + 0.5) / volume_samples,
                             z = (c + 0.5) / volume_samples;
                count += trilinear(hot, x, y, z) > 0.0 && trilinear(inside, x, y, z) > 0.0;
            }
    return double(count) / (volume_samples * volume_samples * volume_samples);
}

} // namespace

PoolFigures measure_pool(const NodeLattice& nodes, const std::vector<double>& temperature,
                         const std::vector<double>& phi, double isotherm, const Vec3& along) {
    const auto [nx, ny, nz] = nodes.count;
    const std::array<std::int64_t, 3> stride{1, nx, nx * ny};
    Vec3 scan(along.x(), along.y(), 0.0);
    scan = scan.norm() > 0.0 ? Vec3(scan.normalized()) : Vec3(Vec3::UnitX());
    const Vec3 across(-scan.y(), scan.x(), 0.0);
    const auto in_scan_frame = [&](const Vec3& p) { return Vec3(p.dot(scan), p.dot(across), p.z()); };

    std::vector<Extent> extents(nz);
    std::vector<double> volumes(nz, 0.0);
#pragma omp parallel for schedule(dynamic, 1)
    for (std::int64_t k = 0; k < nz; ++k)
        for (std::int64_t j = 0; j < ny; ++j)
            for (std::int64_t i = 0; i < nx; ++i) {
                const std::int64_t at = i + nx * j + stride[2] * k;
                const Vec3 p = nodes.origin + nodes.spacing * Vec3(double(i), double(j), double(k));
                const std::array<bool, 3> has_next{i + 1 < nx, j + 1 < ny, k + 1 < nz};
                for (int axis = 0; axis < 3; ++axis) {
                    if (!has_next[axis])
                        continue;
                    const std::int64_t next = at + stride[axis];
                    if (temperature[at] <= isotherm && temperature[next] <= isotherm)
                        continue;
                    Stretch stretch;
                    stretch.cut(temperature[at] - isotherm, temperature[next] - isotherm);
                    stretch.cut(-phi[at], -phi[next]);
                    if (stretch.empty())
                        continue;
                    const Vec3 edge = nodes.spacing * Vec3::Unit(axis);
                    extents[k].take(in_scan_frame(p + stretch.first * edge));
                    extents[k].take(in_scan_frame(p + stretch.last * edge));
                }
                if (!has_next[0] || !has_next[1] || !has_next[2])
                    continue;
                std::array<double, 8> hot, inside;
                bool any = false;
                for (int c = 0; c < 8; ++c) {
                    const std::int64_t corner =
                        at + (c & 1) + ((c >> 1) & 1) * stride[1] + ((c >> 2) & 1) * stride[2];
                    hot[c] = temperature[corner] - isotherm;
                    inside[c] = -phi[corner];
                    any = any || hot[c] > 0.0;
                }
                if (any)
                    volumes[k] += cell_volume(hot, inside);
            }

    PoolFigures pool;
    pool.isotherm = isotherm;
    Extent all;
    double cells = 0.0;
    for (std::int64_t k = 0; k < nz; ++k) {
        all.take(extents[k]);
        cells += volumes[k];
    }
    if (all.low[0] > all.high[0])
        return pool;
    const Vec3 size = all.high - all.low;
    pool.length = size[0];
    pool.width = size[1];
    pool.depth = size[2];
    pool.volume = cells * nodes.spacing * nodes.spacing * nodes.spacing;
    return pool;
}

} // namespace meltscope
