#include "reference/conduction.hpp"
#include "reference/driver.hpp"
#include "reference/table.hpp"

#include "meltscope/mpm/free_surface.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

struct Result {
    double at_surface = 0.0; ///< error by the rise of the surface
    double in_depth = 0.0;   ///< largest error of the profile by the rise of the surface
    double area = 0.0;       ///< error of the elements' total area, relative
};

/// Heats the free surface of a column by deposit(); the surface lies `above` cells above a plane of nodes.
/// t = 0.02, alpha = kappa = 1, column 1 deep.
Result heat_column(int cells, double above, bool at_surface, bool affine, ResultTable* profile = nullptr) {
    const double dx = 1.0 / cells, q = 2000.0, t = 0.02;
    const double top = above * dx;
    const Grid grid = make_grid(Vec3(0, 0, -1.0), dx, {2, 2, cells + 4});
    const std::vector<EquationOfState> materials{make_equation_of_state(constant_material())};
    ParticleList list = lattice_points(grid, 2, [=](const Vec3& x) { return x[2] < top; });
    set_state(
        materials, [](const Vec3&) { return 1000.0; }, list);
    Stepping stepping;
    stepping.affine = affine;
    stepping.blend = affine ? -1.0 : 0.0;
    ThermalRun run(grid, materials, Boundary{}, std::move(list), 2, stepping);
    const FreeSurface surface = find_free_surface(grid, run.particles, run.nodes, {}, at_surface);
    std::vector<double> heat(surface.elements.count());
    double area = 0.0, deposited = 0.0;
    for (const double a : surface.elements.area)
        area += a;
    run.advance(t, 1.0, [&](double dt) {
        for (std::int64_t s = 0; s < surface.elements.count(); ++s)
            heat[s] = q * surface.elements.area[s] * dt;
        deposit(grid, surface.elements, heat, run.nodes);
        deposited += q * area * dt;
    });
    EXPECT_NEAR(total_energy(run.particles) - run.start_energy, deposited, 1e-12 * run.start_energy);

    Result result;
    result.area = area / (4.0 * dx * dx) - 1.0;
    const double rise = flux_profile(0.0, q, 1.0, 1.0, t);
    for (int i = 0; i <= cells; ++i) {
        const double depth = i * dx;
        const double exact = flux_profile(depth, q, 1.0, 1.0, t);
        const double got = run.temperature(Vec3(dx, dx, top - depth)) - 1000.0;
        if (i == 0)
            result.at_surface = got / rise - 1.0;
        result.in_depth = std::max(result.in_depth, std::abs(got - exact) / rise);
        if (profile)
            profile->row({depth, exact, got});
    }
    return result;
}

TEST(ConstantFlux, half_space_warms_as_the_formula_says) {
    ResultTable table("constant_flux",
                      "cells,surface_above_node,surface_error_percent,max_error_percent,area_error_percent");
    ResultTable profile("constant_flux_profile", "depth,exact,computed");
    for (const double above : {0.0, 0.5})
        for (const int cells : {25, 50, 100}) {
            const Result r =
                heat_column(cells, above, true, true, cells == 25 && above == 0.0 ? &profile : nullptr);
            EXPECT_LT(std::abs(r.at_surface), cells == 25 ? 0.02 : 0.01) << cells << " cells, " << above;
            EXPECT_LT(r.in_depth, cells == 25 ? 0.02 : 0.01) << cells << " cells, " << above;
            EXPECT_LT(std::abs(r.area), 0.005);
            table.row({double(cells), above, 100.0 * r.at_surface, 100.0 * r.in_depth, 100.0 * r.area});
        }
}

TEST(ConstantFlux, heat_in_the_band_and_values_alone_are_worse) {
    ResultTable table("constant_flux_forms", "form,surface_error_percent,max_error_percent");
    const double best = heat_column(50, 0.0, true, true).in_depth;
    struct Form {
        const char* name;
        bool at_surface, affine;
    };
    for (const Form& form : {Form{"affine surface", true, true}, Form{"affine band", false, true},
                             Form{"flip surface", true, false}, Form{"flip band", false, false}}) {
        const Result r = heat_column(50, 0.0, form.at_surface, form.affine);
        table.row(form.name, {100.0 * r.at_surface, 100.0 * r.in_depth});
        if (!form.at_surface || !form.affine) {
            EXPECT_GT(r.in_depth, 2.0 * best) << form.name;
        }
    }
}

} // namespace
} // namespace meltscope::verification
