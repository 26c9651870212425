#include "reference/conduction.hpp"
#include "reference/driver.hpp"
#include "reference/table.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

struct Errors {
    double most = 0.0; ///< of the largest rise at the end
    double rms = 0.0;
    double energy = 0.0; ///< relative
};

/// A Gaussian spot near a corner of an adiabatic box spreads from t = 0.02 to 0.05 (alpha = 1, box 1 x 0.75 x
/// 0.75).
Errors spread_spot(int cells, bool affine) {
    const Vec3 size(1.0, 0.75, 0.75), centre(0.35, 0.2, 0.5);
    const double from = 0.02, to = 0.05;
    const Grid grid = make_grid(Vec3::Zero(), 1.0 / cells, {cells, 3 * cells / 4, 3 * cells / 4});
    const std::vector<EquationOfState> materials{make_equation_of_state(constant_material())};
    const double scale = 400.0 / heat_kernel(centre, centre, size, 1.0, from); // K m^3
    ParticleList list = lattice_points(grid, 2, everywhere);
    set_state(
        materials, [&](const Vec3& x) { return 1000.0 + scale * heat_kernel(x, centre, size, 1.0, from); },
        list);
    Stepping stepping;
    stepping.affine = affine;
    stepping.blend = affine ? -1.0 : 0.0;
    ThermalRun run(grid, materials, Boundary{}, std::move(list), 2, stepping);
    run.advance(to - from, 1.0);

    Errors errors;
    const double peak = scale * heat_kernel(centre, centre, size, 1.0, to);
    for (const Vec3& x : run.particles.position) {
        const double error =
            (run.temperature(x) - 1000.0 - scale * heat_kernel(x, centre, size, 1.0, to)) / peak;
        errors.most = std::max(errors.most, std::abs(error));
        errors.rms += error * error / double(run.particles.count());
    }
    errors.rms = std::sqrt(errors.rms);
    errors.energy = std::abs(total_energy(run.particles) / run.start_energy - 1.0);
    return errors;
}

void expect_order(bool affine, const std::string& name) {
    ResultTable table("heat_kernel_" + name, "cells,max_error,rms_error,order_max,order_rms,energy_error");
    Errors coarser;
    for (const int cells : {12, 24, 48}) {
        const Errors errors = spread_spot(cells, affine);
        double order = 0.0, order_rms = 0.0;
        if (cells > 12) {
            order = observed_order(coarser.most, errors.most, 2.0, 1.0);
            order_rms = observed_order(coarser.rms, errors.rms, 2.0, 1.0);
            EXPECT_GE(order, 1.9) << cells << " cells";
            EXPECT_GE(order_rms, 1.9) << cells << " cells";
        }
        EXPECT_LT(errors.energy, 1e-13);
        table.row({double(cells), errors.most, errors.rms, order, order_rms, errors.energy});
        coarser = errors;
    }
}

TEST(HeatKernel, spreads_in_an_adiabatic_box_at_second_order) {
    expect_order(true, "affine");
}

TEST(HeatKernel, spreads_at_second_order_with_the_values_alone_carried) {
    expect_order(false, "flip");
}

} // namespace
} // namespace meltscope::verification
