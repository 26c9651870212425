#include "reference/driver.hpp"
#include "reference/table.hpp"

#include "meltscope/beam/radiative_exchange.hpp"
#include "meltscope/beam/surface_losses.hpp"
#include "meltscope/constants.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

constexpr double dx = 5e-6, inner = 6.0 * dx, outer = 11.0 * dx, ambient = 300.0; // m, K

Vec3 middle() {
    return dx * Vec3(13.1, 12.9, 13.05);
}

Material grey(double emissivity) {
    Material material = constant_material(25.0, 8000.0, 600.0);
    material.emissivity = emissivity;
    return material;
}

/// A ball in the middle of a hollow of the same material, and what its surfaces exchange.
struct Enclosure {
    Material material;
    std::vector<EquationOfState> eos;
    ThermalRun run;
    FreeSurface surface;
    std::vector<LossLaw> laws;
    LossElements loss;
    RadiativeExchange exchange;

    Enclosure(double emissivity, double temperature)
        : material(grey(emissivity)), eos{make_equation_of_state(material)}, run(make_run(eos, temperature)),
          surface(find_free_surface(run.grid, run.particles, run.nodes, {}, true)) {
        LossOptions options;
        options.radiation = true;
        options.ambient = ambient;
        laws = make_loss_laws({material}, options);
        loss = make_loss_elements(run.grid, run.boundary, surface.elements, run.nodes);
        exchange = make_radiative_exchange(run.grid, surface, run.particles, {material}, {});
    }

    static ThermalRun make_run(const std::vector<EquationOfState>& eos, double temperature) {
        const Grid grid = make_grid(Vec3::Zero(), dx, Index3::Constant(26));
        ParticleList list = lattice_points(grid, 2, [](const Vec3& x) {
            const double r = (x - middle()).norm();
            return r < inner || r > outer;
        });
        set_state(
            eos, [&](const Vec3&) { return temperature; }, list);
        return ThermalRun(grid, eos, Boundary{}, std::move(list), 2);
    }
};

TEST(Cavity, a_ball_in_a_hollow_exchanges_what_concentric_spheres_do) {
    ResultTable table("cavity", "emissivity,exact_W,computed_W,error_percent,factors,seconds,bytes");
    for (const double emissivity : {1.0, 0.7, 0.4, 0.2}) {
        const Enclosure e(emissivity, ambient);
        const SurfaceElements& elements = e.surface.elements;
        std::vector<double> temperature(elements.count()), power(elements.count(), 0.0);
        const auto on_ball = [&](std::int64_t s) {
            return (elements.point[s] - middle()).norm() < 0.5 * (inner + outer);
        };
        for (std::int64_t s = 0; s < elements.count(); ++s)
            temperature[s] = on_ball(s) ? 2000.0 : ambient;
        reabsorbed_power(e.exchange, elements, temperature, ambient, power);
        double gained = 0.0; // by the shell, W
        for (std::int64_t s = 0; s < elements.count(); ++s)
            gained += on_ball(s) ? 0.0 : power[s];
        const double ratio = (inner * inner) / (outer * outer);
        const double exact = 4.0 * constants::pi * inner * inner * constants::stefan_boltzmann *
                             (std::pow(2000.0, 4) - std::pow(ambient, 4)) /
                             (1.0 / emissivity + ratio * (1.0 / emissivity - 1.0));
        EXPECT_NEAR(gained, exact, 0.05 * exact) << "emissivity " << emissivity;
        EXPECT_EQ(e.exchange.cost.stray_rays, 0);
        table.row({emissivity, exact, gained, 100.0 * (gained / exact - 1.0), double(e.exchange.cost.factors),
                   e.exchange.cost.seconds, double(e.exchange.cost.bytes)});
    }
}

TEST(Cavity, closed_and_isothermal_it_loses_nothing) {
    Enclosure e(0.4, 1900.0);
    ThermalRun& run = e.run;
    const SurfaceElements& elements = e.surface.elements;
    std::vector<double> temperature, energy;
    double radiated = 0.0, reabsorbed = 0.0;
    run.advance(50 * 0.5 * dx * dx / 5.2e-6, 5.2e-6, [&](double dt) {
        surface_temperatures(run.grid, elements, run.nodes, temperature);
        energy.assign(temperature.size(), 0.0);
        reabsorbed += dt * reabsorbed_power(e.exchange, elements, temperature, ambient, energy);
        for (double& joule : energy)
            joule *= dt;
        deposit(run.grid, elements, energy, run.nodes);
        radiated +=
            deposit_losses(run.grid, run.boundary, e.laws, e.eos, elements, dt, e.loss, run.nodes).radiated;
    });
    // The loss is implicit, its coefficient and the gain are of the step's start: they differ by what the
    // unevenness of the surface does to the gain within a step.
    EXPECT_NEAR(radiated, reabsorbed, 1e-6 * radiated);
    EXPECT_NEAR(run.coldest_particle(), 1900.0, 1e-3);
    EXPECT_NEAR(run.hottest_particle(), 1900.0, 1e-3);
}

} // namespace
} // namespace meltscope::verification
