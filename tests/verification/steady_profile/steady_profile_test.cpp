#include "reference/driver.hpp"
#include "reference/table.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

constexpr double cold = 500.0, hot = 1500.0; // K, of the two faces

Boundary two_faces(int axis) {
    Boundary boundary;
    boundary[2 * axis] = {FaceCondition::Kind::fixed_temperature, cold, 0.0, 0.0};
    boundary[2 * axis + 1] = {FaceCondition::Kind::fixed_temperature, hot, 0.0, 0.0};
    return boundary;
}

/// Largest error in K of the steady profile in a bar of `cells` cells along `axis`, from a start at
/// `start(x)`.
double error_after(double duration, double alpha, int cells, int axis, const Material& material,
                   const std::function<double(double)>& exact, const std::function<double(double)>& start,
                   ResultTable* profile = nullptr) {
    Index3 count = Index3::Ones();
    count[axis] = cells;
    const Grid grid = make_grid(Vec3::Zero(), 1.0 / cells, count);
    const std::vector<EquationOfState> materials{make_equation_of_state(material)};
    ParticleList list = lattice_points(grid, 2, everywhere);
    set_state(
        materials, [&](const Vec3& x) { return start(x[axis]); }, list);
    ThermalRun run(grid, materials, two_faces(axis), std::move(list), 2);
    run.advance(duration, alpha);
    double most = 0.0;
    for (int i = 0; i <= 2 * cells; ++i) {
        Vec3 x = Vec3::Constant(0.5 / cells);
        x[axis] = 0.5 * i / cells;
        most = std::max(most, std::abs(run.temperature(x) - exact(x[axis])));
        if (profile)
            profile->row({x[axis], exact(x[axis]), run.temperature(x)});
    }
    return most;
}

TEST(SteadyProfile, linear_profile_between_two_faces_stays_to_round_off) {
    const auto linear = [](double x) { return cold + (hot - cold) * x; };
    ResultTable table("steady_profile_linear", "axis,max_error_K");
    for (int axis = 0; axis < 3; ++axis) {
        const double error = error_after(0.5, 1.0, 16, axis, constant_material(), linear, linear);
        EXPECT_LT(error, 1e-9) << "K, axis " << axis;
        table.row({double(axis), error});
    }
}

TEST(SteadyProfile, linear_profile_is_reached_from_a_uniform_start) {
    const auto linear = [](double x) { return cold + (hot - cold) * x; };
    const double error =
        error_after(3.0, 1.0, 16, 0, constant_material(), linear, [](double) { return 800.0; });
    EXPECT_LT(error, 1e-8) << "K; the slowest mode has shrunk by exp(-3 pi^2)";
}

TEST(SteadyProfile, with_conductivity_linear_in_temperature_it_converges_at_second_order) {
    // kappa = a + b T: the integral a T + b T^2/2 is linear in x (Kirchhoff).
    const double a = 0.5, b = 1e-3;
    Material material = constant_material();
    material.conductivity.solid = material.conductivity.liquid = {{a, b, 0.0}};
    const auto transformed = [=](double t) { return a * t + 0.5 * b * t * t; };
    const auto exact = [=](double x) {
        const double theta = transformed(cold) + (transformed(hot) - transformed(cold)) * x;
        return (std::sqrt(a * a + 2.0 * b * theta) - a) / b;
    };
    ResultTable table("steady_profile", "cells,max_error_K,order");
    ResultTable profile("steady_profile_profile", "x,exact,computed");
    double coarser = 0.0;
    for (const int cells : {16, 32, 64}) {
        const double error =
            error_after(1.0, a + b * hot, cells, 0, material, exact, exact, cells == 16 ? &profile : nullptr);
        const double order = coarser > 0.0 ? observed_order(coarser, error, 2.0, 1.0) : 0.0;
        if (coarser > 0.0) {
            EXPECT_GE(order, 1.9) << cells << " cells";
        }
        table.row({double(cells), error, order});
        coarser = error;
    }
}

} // namespace
} // namespace meltscope::verification
