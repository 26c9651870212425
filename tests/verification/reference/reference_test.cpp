#include "reference/conduction.hpp"
#include "reference/eagar_tsai.hpp"
#include "reference/stefan.hpp"
#include "reference/table.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

constexpr double printed = 0.6e-6; // the table has six digits

TEST(Reference, stefan_roots_are_those_of_the_table) {
    EXPECT_NEAR((Stefan{1.0, 1.0, 1.0}.root()),
                reference_value("stefan_neumann", "lambda(St_l=1;St_s=1;nu=1)"), printed);
    EXPECT_NEAR((Stefan{2.0, 1.0, 1.0}.root()),
                reference_value("stefan_neumann", "lambda(St_l=2;St_s=1;nu=1)"), printed);
    EXPECT_NEAR((Stefan{0.1, 0.0, 1.0}.root()), reference_value("stefan_one_phase", "lambda(St=0.1)"),
                printed);
    EXPECT_NEAR((Stefan{1.0, 0.0, 1.0}.root()), reference_value("stefan_one_phase", "lambda(St=1)"), printed);
}

TEST(Reference, eagar_tsai_integral_gives_the_figures_of_the_table) {
    EagarTsai beam; // kappa = sigma = A P = 1, so that dT is theta
    for (const int peclet : {1, 2}) {
        beam.speed = peclet;
        const std::string end = " Pe=" + std::to_string(peclet);
        EXPECT_NEAR(beam.steady_rise(Vec3(0, 0, 0)), reference_value("eagar_tsai", "theta origin" + end),
                    printed);
        EXPECT_NEAR(beam.steady_rise(Vec3(0, 0, -1)),
                    reference_value("eagar_tsai", "theta at depth sigma" + end), printed);
    }
}

TEST(Reference, eagar_tsai_after_a_long_time_is_steady) {
    EagarTsai beam;
    beam.speed = 2.0;
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(-1, 0.5, -0.5)})
        EXPECT_NEAR(beam.rise(Vec3(beam.beam(60.0), 0, 0) + p, 60.0), beam.steady_rise(p), 1e-9);
}

TEST(Reference, eagar_tsai_between_walls_keeps_its_energy) {
    EagarTsai beam;
    beam.speed = 3.0;
    beam.start = 1.5;
    beam.x_low = 0.0;
    beam.x_high = 6.0;
    beam.half_width = 2.0;
    beam.depth = 1.5;
    const double elapsed = 1.0;
    double heat = 0.0;
    const double h = 0.25; // midpoint rule; the beam's own edges lie inside the walls up to a few 1e-3
    for (double z = -h / 2; z > -1.5; z -= h)
        for (double y = h / 2; y < 2.0; y += h)
            for (double x = h / 2; x < 6.0; x += h)
                heat += 2.0 * h * h * h * beam.rise(Vec3(x, y, z), elapsed);
    EXPECT_NEAR(heat, beam.absorbed_power * elapsed, 0.01);
}

TEST(Reference, eagar_tsai_on_a_grid_is_eagar_tsai_point_by_point) {
    EagarTsai beam;
    beam.speed = 2.0;
    beam.x_low = -1.0;
    beam.x_high = 5.0;
    beam.half_width = 2.0;
    beam.depth = 1.5;
    const std::vector<double> x{-1.0, 0.5, 1.7}, y{-2.0, 0.3}, z{-1.5, -0.1, 0.0};
    const std::vector<double> rise = beam.rise_on(x, y, z, 0.9);
    for (std::size_t k = 0, at = 0; k < z.size(); ++k)
        for (std::size_t j = 0; j < y.size(); ++j)
            for (std::size_t i = 0; i < x.size(); ++i, ++at)
                EXPECT_NEAR(rise[at], beam.rise(Vec3(x[i], y[j], z[k]), 0.9), 1e-14);
}

TEST(Reference, flux_profile_gives_the_figures_of_the_table) {
    EXPECT_NEAR(flux_profile(0.0, 1.0, 1.0, 1.0, 1.0),
                reference_value("constant_flux", "dT k/(q sqrt(alpha t)) at x=0"), printed);
    EXPECT_NEAR(flux_profile(1.0, 1.0, 1.0, 1.0, 1.0),
                reference_value("constant_flux", "dT k/(q sqrt(alpha t)) at x=sqrt(alpha t)"), printed);
}

TEST(Reference, heat_kernel_between_walls_integrates_to_one) {
    double sum = 0.0;
    const int n = 400;
    for (int i = 0; i < n; ++i)
        sum += heat_kernel((i + 0.5) / n, 0.3, 1.0, 1.0, 0.05) / n;
    EXPECT_NEAR(sum, 1.0, 1e-6);
}

} // namespace
} // namespace meltscope::verification
