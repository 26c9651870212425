#include "meltscope/mpm/stencil.hpp"

#include <gtest/gtest.h>

namespace meltscope {
namespace {

const std::vector<double> offsets{-0.5, -0.41, -0.25, 0.0, 0.1, 0.25, 0.37, 0.5};

TEST(BSpline, weights_are_not_negative_and_sum_to_one) {
    for (const double r : offsets) {
        const BSpline<double> n(r);
        EXPECT_NEAR(n.value[0] + n.value[1] + n.value[2], 1.0, 1e-15);
        EXPECT_NEAR(n.derivative[0] + n.derivative[1] + n.derivative[2], 0.0, 1e-15);
        for (const double value : n.value)
            EXPECT_GE(value, 0.0);
    }
}

TEST(BSpline, weights_follow_their_formula) {
    const auto formula = [](double x) {
        x = std::abs(x);
        return x <= 0.5 ? 0.75 - x * x : x <= 1.5 ? 0.5 * (1.5 - x) * (1.5 - x) : 0.0;
    };
    for (const double r : offsets)
        for (int i = -1; i <= 1; ++i)
            EXPECT_NEAR(BSpline<double>(r).value[i + 1], formula(r - i), 1e-15);
}

TEST(BSpline, linear_fields_and_their_slope_are_exact) {
    for (const double r : offsets) {
        const BSpline<double> n(r);
        EXPECT_NEAR(n.value[2] - n.value[0], r, 1e-15);
        EXPECT_NEAR(n.derivative[2] - n.derivative[0], 1.0, 1e-15);
        EXPECT_NEAR(n.moment[0] + n.moment[1] + n.moment[2], 0.0, 1e-15);
    }
}

TEST(BSpline, derivatives_are_the_slopes_of_the_weights) {
    const double h = 1e-6;
    for (const double r : {-0.4, -0.1, 0.0, 0.3})
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(BSpline<double>(r).derivative[i],
                        (BSpline<double>(r + h).value[i] - BSpline<double>(r - h).value[i]) / (2.0 * h),
                        1e-9);
}

TEST(BSpline, variance_is_a_quarter) {
    for (const double r : offsets) {
        const BSpline<double> n(r);
        EXPECT_NEAR(n.value[0] + n.value[2] - 2.0 * r * (n.value[2] - n.value[0]) + r * r, 0.25, 1e-15);
    }
}

} // namespace
} // namespace meltscope
