#include "reference/conduction.hpp"
#include "reference/driver.hpp"
#include "reference/table.hpp"

#include "meltscope/beam/surface_losses.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

/// Largest error of the profile, by the rise of the surface, of a column with alpha = kappa = 1 and ambient
/// 1000 K that takes the flux q and convects with h for t = 0.02.
double error_with_convection(int cells) {
    const double dx = 1.0 / cells, q = 2000.0, h = 10.0, t = 0.02, ambient = 1000.0;
    const Grid grid = make_grid(Vec3(0, 0, -1.0), dx, {2, 2, cells + 4});
    const Material material = constant_material();
    const std::vector<EquationOfState> eos{make_equation_of_state(material)};
    ParticleList list = lattice_points(grid, 2, [](const Vec3& x) { return x[2] < 0.0; });
    set_state(
        eos, [=](const Vec3&) { return ambient; }, list);
    ThermalRun run(grid, eos, Boundary{}, std::move(list), 2, Stepping{});
    const FreeSurface surface = find_free_surface(grid, run.particles, run.nodes, {}, true);
    const SurfaceElements& elements = surface.elements;
    LossOptions options;
    options.convection = h;
    options.ambient = ambient;
    const std::vector<LossLaw> laws = make_loss_laws({material}, options);
    LossElements loss = make_loss_elements(grid, Boundary{}, elements, run.nodes);

    double gained = 0.0; // J
    std::vector<double> heat(elements.count());
    run.advance(t, 1.0, [&](double dt) {
        for (std::int64_t s = 0; s < elements.count(); ++s) {
            heat[s] = q * elements.area[s] * dt;
            gained += heat[s];
        }
        deposit(grid, elements, heat, run.nodes);
        gained -= deposit_losses(grid, Boundary{}, laws, eos, elements, dt, loss, run.nodes).convected;
    });
    EXPECT_NEAR(total_energy(run.particles) - run.start_energy, gained, 1e-12 * run.start_energy);

    const double rise = flux_with_loss_profile(0.0, q, h, 1.0, 1.0, t);
    double worst = 0.0;
    for (int i = 0; i <= cells / 2; ++i) {
        const double exact = flux_with_loss_profile(i * dx, q, h, 1.0, 1.0, t);
        worst = std::max(worst, std::abs(run.temperature(Vec3(dx, dx, -i * dx)) - ambient - exact) / rise);
    }
    return worst;
}

TEST(ConstantFlux, with_convection_follows_the_formula) {
    ResultTable table("constant_flux_with_convection", "cells,max_error_percent");
    for (const int cells : {25, 50, 100}) {
        const double error = error_with_convection(cells);
        table.row({double(cells), 100.0 * error});
        RecordProperty("error_percent_" + std::to_string(cells), std::to_string(100.0 * error));
        EXPECT_LT(error, cells == 25 ? 0.02 : 0.01) << cells << " cells";
    }
}

} // namespace
} // namespace meltscope::verification
