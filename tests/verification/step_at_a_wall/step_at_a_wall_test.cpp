#include "reference/conduction.hpp"
#include "reference/driver.hpp"
#include "reference/table.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

/// A bar along `axis`, one cell thick, whose lower end is suddenly held 100 K above the rest. Largest error
/// in K over the bar at t = 0.02 (alpha = 1, length 1, so that the far end does not feel it).
double largest_error(int cells, int axis, bool upper_end, ResultTable* profile = nullptr) {
    Index3 count = Index3::Ones();
    count[axis] = cells;
    const Grid grid = make_grid(Vec3::Zero(), 1.0 / cells, count);
    const std::vector<EquationOfState> materials{make_equation_of_state(constant_material())};
    ParticleList list = lattice_points(grid, 2, everywhere);
    set_state(
        materials, [](const Vec3&) { return 300.0; }, list);
    Boundary boundary;
    boundary[2 * axis + (upper_end ? 1 : 0)] = {FaceCondition::Kind::fixed_temperature, 400.0, 0.0, 0.0};
    ThermalRun run(grid, materials, boundary, std::move(list), 2);
    const double t = 0.02;
    run.advance(t, 1.0);
    EXPECT_NEAR(run.conducted, total_energy(run.particles) - run.start_energy, 1e-12 * run.start_energy);
    double most = 0.0;
    for (int i = 0; i <= 2 * cells; ++i) {
        Vec3 x = Vec3::Constant(0.5 / cells);
        const double depth = 0.5 * i / cells;
        x[axis] = upper_end ? 1.0 - depth : depth;
        const double exact = 300.0 + 100.0 * step_profile(depth, 1.0, t), got = run.temperature(x);
        most = std::max(most, std::abs(got - exact));
        if (profile)
            profile->row({depth, exact, got});
    }
    return most;
}

TEST(StepAtAWall, follows_the_error_function_at_second_order) {
    ResultTable table("step_at_a_wall", "cells,max_error_percent,order");
    ResultTable profile("step_at_a_wall_profile", "depth,exact,computed");
    double coarser = 0.0;
    for (const int cells : {25, 50, 100, 200}) {
        const double error = largest_error(cells, 0, false, cells == 25 ? &profile : nullptr);
        const double order = coarser > 0.0 ? observed_order(coarser, error, 2.0, 1.0) : 0.0;
        if (coarser > 0.0) {
            EXPECT_GE(order, 1.9) << cells << " cells";
        }
        table.row({double(cells), error, order});
        coarser = error;
    }
    EXPECT_LT(coarser, 0.01) << "per cent of the step";
}

TEST(StepAtAWall, is_the_same_along_every_axis_and_from_either_end) {
    const double reference = largest_error(40, 0, false);
    for (int axis = 0; axis < 3; ++axis)
        for (const bool upper_end : {false, true})
            EXPECT_NEAR(largest_error(40, axis, upper_end), reference, 1e-9)
                << "axis " << axis << ", " << upper_end;
}

} // namespace
} // namespace meltscope::verification
