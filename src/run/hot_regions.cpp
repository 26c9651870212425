#include "hot_regions.hpp"

#include <algorithm>

namespace meltscope {

HotRegions::HotRegions(const NodeLattice& nodes, const std::vector<double>& temperature,
                       const std::vector<double>& phi, double isotherm)
    : nodes_(nodes), temperature_(temperature), phi_(phi), isotherm_(isotherm) {
    if (find_box())
        label();
}

bool HotRegions::belongs(std::int64_t node) const {
    // A node a little outside belongs too: edges reach from it into the material.
    return temperature_[node] > isotherm_ && phi_[node] < 0.75 * nodes_.spacing;
}

bool HotRegions::find_box() {
    const std::int64_t nx = nodes_.count[0], ny = nodes_.count[1], nz = nodes_.count[2];
    std::int64_t i0 = nx, i1 = -1, j0 = ny, j1 = -1, k0 = nz, k1 = -1;
#pragma omp parallel for schedule(static) reduction(min : i0, j0, k0) reduction(max : i1, j1, k1)
    for (std::int64_t k = 0; k < nz; ++k)
        for (std::int64_t j = 0; j < ny; ++j)
            for (std::int64_t i = 0; i < nx; ++i)
                if (belongs(index(i, j, k))) {
                    i0 = std::min(i0, i), i1 = std::max(i1, i);
                    j0 = std::min(j0, j), j1 = std::max(j1, j);
                    k0 = std::min(k0, k), k1 = std::max(k1, k);
                }
    if (i1 < 0) {
        box_ = {{0, 0, 0}, {-1, -1, -1}};
        return false;
    }
    const std::array<std::int64_t, 3> low{i0, j0, k0}, high{i1, j1, k1};
    for (int axis = 0; axis < 3; ++axis) {
        box_.first[axis] = std::max<std::int64_t>(low[axis] - 1, 0);
        box_.last[axis] = std::min(high[axis] + 1, nodes_.count[axis] - 1);
        size_[axis] = box_.last[axis] - box_.first[axis] + 1;
    }
    return true;
}

/// Floods each region from the first of its nodes.
void HotRegions::label() {
    label_.assign(std::size_t(size_[0] * size_[1] * size_[2]), -1);
    std::vector<std::array<std::int64_t, 3>> open;
    const auto take = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
        int& mark = label_[slot(i, j, k)];
        if (mark < 0 && belongs(index(i, j, k))) {
            mark = count_;
            open.push_back({i, j, k});
        }
    };
    const auto& [first, last] = box_;
    for (std::int64_t k = first[2]; k <= last[2]; ++k)
        for (std::int64_t j = first[1]; j <= last[1]; ++j)
            for (std::int64_t i = first[0]; i <= last[0]; ++i) {
                take(i, j, k);
                if (open.empty())
                    continue;
                while (!open.empty()) {
                    const auto [a, b, c] = open.back();
                    open.pop_back();
                    for (auto w = std::max(c - 1, first[2]); w <= std::min(c + 1, last[2]); ++w)
                        for (auto v = std::max(b - 1, first[1]); v <= std::min(b + 1, last[1]); ++v)
                            for (auto u = std::max(a - 1, first[0]); u <= std::min(a + 1, last[0]); ++u)
                                take(u, v, w);
                }
                ++count_;
            }
}

} // namespace meltscope
