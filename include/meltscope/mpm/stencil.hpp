#pragma once

#include "meltscope/lanes.hpp"

#include <array>
#include <cstdint>

namespace meltscope {

/// Quadratic B-spline on unit spacing: N(r) = 3/4 - r^2 for |r| <= 1/2, (3/2 - |r|)^2 / 2 for 1/2 < |r| <=
/// 3/2. `offset` r of a point from its nearest node, -1/2 <= r <= 1/2; weights of the nodes -1, 0, +1 around
/// that node.
template <class Number>
struct BSpline {
    std::array<Number, 3> value;      ///< N
    std::array<Number, 3> derivative; ///< dN/dr
    std::array<Number, 3> moment;     ///< N (x_i - x_p), x in units of the spacing

    BSpline() = default;
    explicit BSpline(const Number& r) {
        const Number left = 0.5 - r, right = 0.5 + r;
        value = {0.5 * left * left, 0.75 - r * r, 0.5 * right * right};
        derivative = {-left, -2.0 * r, right};
        moment = {value[0] * (-1.0 - r), -value[1] * r, value[2] * (1.0 - r)};
    }
};

/// Values and first derivatives of a field at the n^3 points of a stencil.
template <int n>
struct Gathered {
    std::array<Lanes, n * n * n> value, x, y, z;
};

/// The 27 nodes around a bin, as sums of a lane group that are still to be added to the grid.
struct NodeSums {
    std::array<Lanes, 27> sum;

    NodeSums() { sum.fill(Lanes(0.0)); }

    /// Adds the sums to `field`; `corner` is the storage index of node (-1,-1,-1) of lane 0.
    void add_to(double* field, std::int64_t corner, std::int64_t stride_y, std::int64_t stride_z) const {
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j) {
                double* row = field + corner + j * stride_y + k * stride_z;
                for (int i = 0; i < 3; ++i)
                    store(load(row + i) + sum[i + 3 * (j + 3 * k)], row + i);
            }
    }
};

/// Transfer between the 27 nodes around a bin and n x n x n points in it that form a tensor product (x_a,
/// y_b, z_c), for `lane_count` bins that are neighbours in x. Weights are doubles where all bins hold the
/// same points (a lattice), Lanes where every bin has its own (then n = 1). Sums are contracted axis by axis:
/// x, y, z on the way to the points, z, y, x on the way back, which is what makes a lattice cheap.
template <int n, class Weight>
struct Stencil {
    static constexpr int points = n * n * n;
    using Points = Gathered<n>;
    static constexpr int point(int a, int b, int c) { return a + n * (b + n * c); }

    std::array<std::array<BSpline<Weight>, n>, 3> axis; ///< [x,y,z][a]

    /// Interpolates `field`: sum_i N_i f_i at each point. `first` points to node (-1,-1,-1) of lane 0.
    void gather(const double* first, std::int64_t stride_y, std::int64_t stride_z,
                std::array<Lanes, points>& value) const {
        std::array<Lanes, n * n * 3> xy; // [a,b,k]
        for (int k = 0; k < 3; ++k) {
            std::array<Lanes, n * 3> x; // [a,j]
            for (int j = 0; j < 3; ++j) {
                const double* row = first + j * stride_y + k * stride_z;
                const Lanes f0 = load(row), f1 = load(row + 1), f2 = load(row + 2);
                for (int a = 0; a < n; ++a)
                    x[a + n * j] = contract(axis[0][a].value, f0, f1, f2);
            }
            for (int b = 0; b < n; ++b)
                for (int a = 0; a < n; ++a)
                    xy[a + n * (b + n * k)] = contract(axis[1][b].value, x[a], x[a + n], x[a + 2 * n]);
        }
        for (int c = 0; c < n; ++c)
            for (int b = 0; b < n; ++b)
                for (int a = 0; a < n; ++a) {
                    const int at = a + n * b;
                    value[point(a, b, c)] =
                        contract(axis[2][c].value, xy[at], xy[at + n * n], xy[at + 2 * n * n]);
                }
    }

    /// The same with sum_i f_i dN_i along x, y and z, per unit spacing.
    void gather(const double* first, std::int64_t stride_y, std::int64_t stride_z,
                Gathered<n>& at_points) const {
        std::array<Lanes, n * n * 3> xy, dx_y, x_dy; // [a,b,k]
        for (int k = 0; k < 3; ++k) {
            std::array<Lanes, n * 3> x, dx; // [a,j]
            for (int j = 0; j < 3; ++j) {
                const double* row = first + j * stride_y + k * stride_z;
                const Lanes f0 = load(row), f1 = load(row + 1), f2 = load(row + 2);
                for (int a = 0; a < n; ++a) {
                    x[a + n * j] = contract(axis[0][a].value, f0, f1, f2);
                    dx[a + n * j] = contract(axis[0][a].derivative, f0, f1, f2);
                }
            }
            for (int b = 0; b < n; ++b)
                for (int a = 0; a < n; ++a) {
                    const int at = a + n * (b + n * k);
                    xy[at] = contract(axis[1][b].value, x[a], x[a + n], x[a + 2 * n]);
                    x_dy[at] = contract(axis[1][b].derivative, x[a], x[a + n], x[a + 2 * n]);
                    dx_y[at] = contract(axis[1][b].value, dx[a], dx[a + n], dx[a + 2 * n]);
                }
        }
        for (int c = 0; c < n; ++c)
            for (int b = 0; b < n; ++b)
                for (int a = 0; a < n; ++a) {
                    const int k0 = a + n * b, k1 = k0 + n * n, k2 = k1 + n * n, p = point(a, b, c);
                    at_points.value[p] = contract(axis[2][c].value, xy[k0], xy[k1], xy[k2]);
                    at_points.x[p] = contract(axis[2][c].value, dx_y[k0], dx_y[k1], dx_y[k2]);
                    at_points.y[p] = contract(axis[2][c].value, x_dy[k0], x_dy[k1], x_dy[k2]);
                    at_points.z[p] = contract(axis[2][c].derivative, xy[k0], xy[k1], xy[k2]);
                }
    }

    /// Adds sum_p v_p . grad N_i to the node sums (the weak divergence of a flux), per unit spacing.
    void scatter_gradient(const Gathered<n>& v, NodeSums& nodes) const {
        scatter<false>(&BSpline<Weight>::derivative, v, nodes);
    }

    /// Adds sum_p N_i (s_p + v_p . (x_i - x_p)) to the node sums (affine P2G), v per unit spacing, s in
    /// v.value.
    void scatter_affine(const Gathered<n>& v, NodeSums& nodes) const {
        scatter<true>(&BSpline<Weight>::moment, v, nodes);
    }

    /// Adds sum_p N_i s_p to the node sums.
    void scatter_value(const std::array<Lanes, points>& s, NodeSums& nodes) const {
        std::array<Lanes, n * n * 3> z; // [a,b,k]
        for (int k = 0; k < 3; ++k)
            for (int ab = 0; ab < n * n; ++ab) {
                Lanes sum = axis[2][0].value[k] * s[ab];
                for (int c = 1; c < n; ++c)
                    sum += axis[2][c].value[k] * s[ab + n * n * c];
                z[ab + n * n * k] = sum;
            }
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j)
                for (int a = 0; a < n; ++a) {
                    Lanes sum = axis[1][0].value[j] * z[a + n * n * k];
                    for (int b = 1; b < n; ++b)
                        sum += axis[1][b].value[j] * z[a + n * b + n * n * k];
                    for (int i = 0; i < 3; ++i)
                        nodes.sum[i + 3 * (j + 3 * k)] += axis[0][a].value[i] * sum;
                }
    }

  private:
    static Lanes contract(const std::array<Weight, 3>& w, const Lanes& f0, const Lanes& f1, const Lanes& f2) {
        return w[0] * f0 + w[1] * f1 + w[2] * f2;
    }

    /// sum_p [ N N N s + D N N v_x + N D N v_y + N N D v_z ], D the member of BSpline that is named.
    template <bool has_value>
    void scatter(std::array<Weight, 3> BSpline<Weight>::*d, const Gathered<n>& v, NodeSums& nodes) const {
        for (int k = 0; k < 3; ++k) {
            std::array<Lanes, n * n> of_x, of_y, rest; // contracted over z, [a,b]
            for (int ab = 0; ab < n * n; ++ab) {
                Lanes sum_x(0.0), sum_y(0.0), sum(0.0);
                for (int c = 0; c < n; ++c) {
                    const int p = ab + n * n * c;
                    const Weight& value = axis[2][c].value[k];
                    sum_x += value * v.x[p];
                    sum_y += value * v.y[p];
                    sum += (axis[2][c].*d)[k] * v.z[p];
                    if constexpr (has_value)
                        sum += value * v.value[p];
                }
                of_x[ab] = sum_x;
                of_y[ab] = sum_y;
                rest[ab] = sum;
            }
            for (int j = 0; j < 3; ++j)
                for (int a = 0; a < n; ++a) {
                    Lanes with_d(0.0), with_value(0.0);
                    for (int b = 0; b < n; ++b) {
                        const Weight& value = axis[1][b].value[j];
                        with_d += value * of_x[a + n * b];
                        with_value += (axis[1][b].*d)[j] * of_y[a + n * b] + value * rest[a + n * b];
                    }
                    for (int i = 0; i < 3; ++i)
                        nodes.sum[i + 3 * (j + 3 * k)] +=
                            (axis[0][a].*d)[i] * with_d + axis[0][a].value[i] * with_value;
                }
        }
    }
};

/// Every bin holds one point of its own.
using PointStencil = Stencil<1, Lanes>;

/// Every bin holds the same n x n x n lattice points.
template <int n>
using LatticeStencil = Stencil<n, double>;

} // namespace meltscope
