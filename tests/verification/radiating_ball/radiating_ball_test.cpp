#include "reference/driver.hpp"
#include "reference/table.hpp"

#include "meltscope/beam/surface_losses.hpp"
#include "meltscope/constants.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

constexpr double radius = 200e-6, start = 2500.0, ambient = 300.0;             // m, K
constexpr double conductivity = 25.0, density = 8000.0, heat_capacity = 600.0; // W/m/K, kg/m^3, J/kg/K

/// T of dT/dt = -3 eps sigma (T^4 - T_amb^4)/(rho c R), by Runge and Kutta's fourth-order rule.
double lumped_temperature(double emissivity, double time) {
    const double factor =
        -3.0 * emissivity * constants::stefan_boltzmann / (density * heat_capacity * radius);
    const auto rate = [&](double t) { return factor * (std::pow(t, 4) - std::pow(ambient, 4)); };
    const int steps = 1000;
    const double h = time / steps;
    double t = start;
    for (int n = 0; n < steps; ++n) {
        const double a = rate(t), b = rate(t + 0.5 * h * a), c = rate(t + 0.5 * h * b), d = rate(t + h * c);
        t += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
    }
    return t;
}

/// Error of the mean temperature's fall, relative, for a ball of `cells` cells radius.
double cooling_error(int cells, ResultTable& table) {
    const double dx = radius / cells;
    const int n = 2 * cells + 6;
    const Grid grid = make_grid(Vec3::Zero(), dx, Index3::Constant(n));
    const Vec3 centre = dx * (Vec3::Constant(0.5 * n) + Vec3(0.31, -0.17, 0.23));
    Material material = constant_material(conductivity, density, heat_capacity);
    material.emissivity = 1.0;
    const std::vector<EquationOfState> eos{make_equation_of_state(material)};
    ParticleList list = lattice_points(grid, 2, [&](const Vec3& x) { return (x - centre).norm() < radius; });
    set_state(
        eos, [](const Vec3&) { return start; }, list);
    Stepping stepping;
    stepping.ambient = ambient;
    ThermalRun run(grid, eos, Boundary{}, std::move(list), 2, stepping);
    const FreeSurface surface = find_free_surface(grid, run.particles, run.nodes, {}, true);
    LossOptions options;
    options.radiation = true;
    options.ambient = ambient;
    const std::vector<LossLaw> laws = make_loss_laws({material}, options);
    LossElements loss = make_loss_elements(grid, run.boundary, surface.elements, run.nodes);
    double mass = 0.0;
    for (const double m : run.particles.mass)
        mass += m;

    double radiated = 0.0, error = 0.0;
    for (int part = 1; part <= 5; ++part) {
        run.advance(0.02, conductivity / (density * heat_capacity), [&](double dt) {
            radiated +=
                deposit_losses(grid, run.boundary, laws, eos, surface.elements, dt, loss, run.nodes).radiated;
        });
        const double mean = total_energy(run.particles) / (mass * heat_capacity);
        const double exact = lumped_temperature(1.0, run.time);
        error = (start - mean) / (start - exact) - 1.0;
        table.row({double(cells), run.time, exact, mean, 100.0 * error});
    }
    EXPECT_NEAR(run.start_energy - total_energy(run.particles), radiated, 1e-12 * run.start_energy);
    return error;
}

TEST(RadiatingBall, cools_as_one_temperature_does) {
    ResultTable table("radiating_ball", "cells_in_radius,time_s,exact_K,computed_K,error_percent");
    for (const int cells : {4, 8})
        EXPECT_LT(std::abs(cooling_error(cells, table)), 0.05) << cells << " cells";
}

} // namespace
} // namespace meltscope::verification
