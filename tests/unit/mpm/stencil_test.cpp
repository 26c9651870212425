#include "meltscope/mpm/group_stencils.hpp"

#include <gtest/gtest.h>

#include <random>

namespace meltscope {
namespace {

constexpr std::int64_t stride_y = 16, stride_z = 48; // room for a group of lanes and two nodes

std::vector<double> random_numbers(std::size_t count) {
    std::mt19937_64 random(7);
    std::vector<double> numbers(count);
    for (double& number : numbers)
        number = std::uniform_real_distribution<double>(-1.0, 1.0)(random);
    return numbers;
}

/// Weight and gradient of node (i,j,k) = 0 .. 2 at offsets (x,y,z), and the distance from the point to the
/// node.
struct Node {
    double n;
    std::array<double, 3> gradient, away;
};

Node node(const std::array<double, 3>& offset, int i, int j, int k) {
    const BSpline<double> x(offset[0]), y(offset[1]), z(offset[2]);
    return {x.value[i] * y.value[j] * z.value[k],
            {x.derivative[i] * y.value[j] * z.value[k], x.value[i] * y.derivative[j] * z.value[k],
             x.value[i] * y.value[j] * z.derivative[k]},
            {i - 1 - offset[0], j - 1 - offset[1], k - 1 - offset[2]}};
}

/// Checks every transfer of `stencil` against sums over 27 nodes; `offset(p, lane)` is where its point p
/// lies.
template <class Stencil, class Offset>
void expect_plain_sums(const Stencil& stencil, Offset offset) {
    constexpr int count = Stencil::points;
    const std::vector<double> field = random_numbers(3 * stride_z);
    std::array<Lanes, count> value;
    typename Stencil::Points all;
    stencil.gather(field.data(), stride_y, stride_z, value);
    stencil.gather(field.data(), stride_y, stride_z, all);

    const std::vector<double> numbers = random_numbers(4 * count * lane_count);
    typename Stencil::Points given;
    for (int p = 0; p < count; ++p) {
        given.value[p] = load(&numbers[4 * p * lane_count]);
        given.x[p] = load(&numbers[(4 * p + 1) * lane_count]);
        given.y[p] = load(&numbers[(4 * p + 2) * lane_count]);
        given.z[p] = load(&numbers[(4 * p + 3) * lane_count]);
    }
    NodeSums values, gradients, affine;
    stencil.scatter_value(given.value, values);
    stencil.scatter_gradient(given, gradients);
    stencil.scatter_affine(given, affine);

    for (int lane = 0; lane < lane_count; ++lane) {
        std::array<double, 27> expected_values{}, expected_gradients{}, expected_affine{};
        for (int p = 0; p < count; ++p) {
            double f = 0.0;
            std::array<double, 3> df{};
            for (int k = 0; k < 3; ++k)
                for (int j = 0; j < 3; ++j)
                    for (int i = 0; i < 3; ++i) {
                        const Node n = node(offset(p, lane), i, j, k);
                        const double here = field[i + lane + j * stride_y + k * stride_z];
                        f += n.n * here;
                        for (int axis = 0; axis < 3; ++axis)
                            df[axis] += n.gradient[axis] * here;
                        const int at = i + 3 * (j + 3 * k);
                        const std::array<double, 3> v{given.x[p][lane], given.y[p][lane], given.z[p][lane]};
                        expected_values[at] += n.n * given.value[p][lane];
                        expected_affine[at] += n.n * given.value[p][lane];
                        for (int axis = 0; axis < 3; ++axis) {
                            expected_gradients[at] += n.gradient[axis] * v[axis];
                            expected_affine[at] += n.n * v[axis] * n.away[axis];
                        }
                    }
            EXPECT_NEAR(value[p][lane], f, 1e-14);
            EXPECT_NEAR(all.value[p][lane], f, 1e-14);
            EXPECT_NEAR(all.x[p][lane], df[0], 1e-14);
            EXPECT_NEAR(all.y[p][lane], df[1], 1e-14);
            EXPECT_NEAR(all.z[p][lane], df[2], 1e-14);
        }
        for (int at = 0; at < 27; ++at) {
            EXPECT_NEAR(values.sum[at][lane], expected_values[at], 1e-13);
            EXPECT_NEAR(gradients.sum[at][lane], expected_gradients[at], 1e-13);
            EXPECT_NEAR(affine.sum[at][lane], expected_affine[at], 1e-13);
        }
    }
}

template <int n>
void expect_lattice(const LatticeStencil<n>& stencil) {
    const std::vector<double> at = lattice_offsets(n);
    expect_plain_sums(stencil, [&](int p, int) {
        return std::array<double, 3>{at[p % n], at[p / n % n], at[p / (n * n)]};
    });
}

TEST(Stencil, lattices_of_one_to_four_points_transfer_as_plain_sums_do) {
    const LatticeStencils lattices;
    expect_lattice(lattices.one);
    expect_lattice(lattices.two);
    expect_lattice(lattices.three);
    expect_lattice(lattices.four);
}

TEST(Stencil, single_points_transfer_as_plain_sums_do) {
    std::vector<double> x, y, z;
    for (int lane = 0; lane < lane_count; ++lane) {
        x.push_back(-0.5 + lane / 9.0);
        y.push_back(0.3 - lane / 11.0);
        z.push_back(0.5 - lane / 8.5);
    }
    expect_plain_sums(point_stencil(x.data(), y.data(), z.data(), 0), [&](int, int lane) {
        return std::array<double, 3>{x[lane], y[lane], z[lane]};
    });
}

TEST(Stencil, sums_of_neighbouring_bins_add_up_on_the_grid) {
    NodeSums sums;
    for (int at = 0; at < 27; ++at)
        sums.sum[at] = Lanes(1.0);
    std::vector<double> field(3 * stride_z, 0.0);
    sums.add_to(field.data(), 0, stride_y, stride_z);
    double total = 0.0;
    for (const double value : field)
        total += value;
    EXPECT_EQ(total, 27.0 * lane_count);
    EXPECT_EQ(field[0], 1.0);
    EXPECT_EQ(field[1], std::min(2, lane_count));
    EXPECT_EQ(field[lane_count + 1], 1.0);
}

} // namespace
} // namespace meltscope
