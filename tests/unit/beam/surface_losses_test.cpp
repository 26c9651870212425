#include "meltscope/beam/surface_losses.hpp"

#include "lattice_block.hpp"

#include "meltscope/constants.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace meltscope {
namespace {

constexpr double plate_dx = 10e-6;

/// A slab whose upper face, at 6.3 cells, is a free surface; the other faces are adiabatic.
LatticeBody slab(double temperature, std::int64_t across = 6) {
    return make_lattice_body(plain_steel(), plate_dx, {across, 4, 9}, temperature,
                             [](const Vec3& x) { return x.z() < 6.3 * plate_dx; });
}

LossOptions only_convection(double h, double ambient) {
    LossOptions options;
    options.convection = h;
    options.ambient = ambient;
    return options;
}

LossOptions all_losses() {
    LossOptions options;
    options.radiation = options.evaporation = true;
    return options;
}

/// One step of conduction, of a given energy in J on every element, and of losses. Returns the losses.
LossEnergy step(LatticeBody& body, const std::vector<LossLaw>& laws, LossElements& loss,
                double supply_per_area, double dt) {
    std::vector<double> energy(body.surface.elements.area);
    for (double& e : energy)
        e *= supply_per_area * dt;
    diffuse(body.grid, body.particles, body.eos, body.options, dt, body.nodes);
    deposit(body.grid, body.surface.elements, energy, body.nodes);
    const LossEnergy lost =
        deposit_losses(body.grid, body.boundary, laws, body.eos, body.surface.elements, dt, loss, body.nodes);
    body.finish_step(dt);
    return lost;
}

double mean_surface_temperature(const LatticeBody& body) {
    std::vector<double> t;
    surface_temperatures(body.grid, body.surface.elements, body.nodes, t);
    return std::accumulate(t.begin(), t.end(), 0.0) / double(t.size());
}

TEST(SurfaceLosses, evaporation_of_steel_carries_off_the_tabled_fluxes) {
    const LossLaw law = make_loss_laws({plain_steel()}, all_losses())[0];
    EXPECT_NEAR(loss_flux(law, 2500.0).evaporation, 9.8e6, 0.02 * 9.8e6);
    EXPECT_NEAR(loss_flux(law, 3068.0).evaporation, 3.6e8, 0.02 * 3.6e8);
    // At the boiling point p_sat = p_atm: 7.45e6 x 0.82 x 101325 sqrt(0.0558 / (2 pi 8.314462618 x 3068)).
    EXPECT_NEAR(loss_flux(law, 3068.0).evaporation, 3.6523e8, 1e-4 * 3.6523e8);
}

TEST(SurfaceLosses, evaporation_begins_where_it_is_negligible) {
    const LossLaw law = make_loss_laws({plain_steel()}, all_losses())[0];
    const double at_boiling = loss_flux(law, 3068.0).evaporation;
    EXPECT_EQ(loss_flux(law, law.evaporation_onset).evaporation, 0.0);
    const double first = loss_flux(law, law.evaporation_onset * (1.0 + 1e-12)).evaporation;
    EXPECT_GT(first, 0.0);
    EXPECT_LT(first, 2.0 * dropped_evaporation * at_boiling);
}

TEST(SurfaceLosses, a_surface_at_ambient_exchanges_exactly_nothing) {
    LossOptions options = all_losses();
    options.convection = 50.0;
    const LossFlux flux = loss_flux(make_loss_laws({plain_steel()}, options)[0], options.ambient);
    EXPECT_EQ(flux.radiation, 0.0);
    EXPECT_EQ(flux.convection, 0.0);
    EXPECT_EQ(flux.evaporation, 0.0);
}

TEST(SurfaceLosses, radiation_follows_the_fourth_power) {
    const LossLaw law = make_loss_laws({plain_steel()}, all_losses())[0];
    const double expected = 0.4 * constants::stefan_boltzmann * (std::pow(1600.0, 4) - std::pow(298.15, 4));
    EXPECT_NEAR(loss_flux(law, 1600.0).radiation, expected, 1e-12 * expected);
}

TEST(SurfaceLosses, a_missing_material_key_is_named) {
    Material bare = plain_steel();
    bare.molar_mass.reset();
    try {
        make_loss_laws({plain_steel(), bare}, all_losses());
        FAIL() << "evaporation without a molar mass was accepted";
    } catch (const std::invalid_argument& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find("'steel' lacks the key 'molar_mass', which evaporation needs"),
                  std::string::npos)
            << message;
    }
    LossOptions radiation;
    radiation.radiation = true;
    EXPECT_NO_THROW(make_loss_laws({bare}, radiation));
}

TEST(SurfaceLosses, what_is_lost_leaves_the_particles) {
    LatticeBody body = slab(3200.0);
    const std::vector<LossLaw> laws = make_loss_laws(body.materials, all_losses());
    LossElements loss = make_loss_elements(body.grid, body.boundary, body.surface.elements, body.nodes);
    const double before = total_energy(body.particles);
    double lost = 0.0;
    for (int n = 0; n < 20; ++n)
        lost += step(body, laws, loss, 0.0, 4e-6).total();
    EXPECT_GT(lost, 1e-3 * before);
    EXPECT_NEAR(before - total_energy(body.particles), lost, 1e-13 * before);
}

TEST(SurfaceLosses, a_small_step_loses_flux_times_area_times_time) {
    LatticeBody body = slab(2900.0);
    const std::vector<LossLaw> laws = make_loss_laws(body.materials, all_losses());
    LossElements loss = make_loss_elements(body.grid, body.boundary, body.surface.elements, body.nodes);
    const double dt = 1e-11;
    const LossEnergy lost = step(body, laws, loss, 0.0, dt);
    const std::vector<double>& areas = body.surface.elements.area;
    const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
    EXPECT_NEAR(area, 6 * 4 * plate_dx * plate_dx, 0.03 * area);
    const LossFlux flux = loss_flux(laws[0], 2900.0);
    EXPECT_NEAR(lost.evaporated, flux.evaporation * area * dt, 1e-3 * lost.evaporated);
    EXPECT_NEAR(lost.radiated, flux.radiation * area * dt, 1e-3 * lost.radiated);
    EXPECT_EQ(lost.convected, 0.0);
}

TEST(SurfaceLosses, an_elements_mass_is_what_an_even_flux_heats) {
    LatticeBody body = slab(300.0);
    LossElements loss = make_loss_elements(body.grid, body.boundary, body.surface.elements, body.nodes);
    std::vector<double> energy, gain;
    for (const double area : body.surface.elements.area)
        energy.push_back(1e3 * area);
    deposit(body.grid, body.surface.elements, energy, body.nodes);
    // Without a law there is no loss, but the nodes' gains are found.
    deposit_losses(body.grid, body.boundary, std::vector<LossLaw>(1), body.eos, body.surface.elements, 1e-6,
                   loss, body.nodes);
    interpolate_to_surface(body.grid, body.surface.elements, loss.gain, gain);
    for (std::size_t s = 0; s < gain.size(); ++s)
        EXPECT_NEAR(gain[s] * loss.mass[body.surface.elements.layout.place[s]], energy[s], 1e-12 * energy[s]);
}

TEST(SurfaceLosses, a_step_of_any_size_never_leads_beyond_ambient) {
    for (const double start : {400.0, 2000.0, 100.0})
        for (const double h : {1e3, 1e9, 1e15}) {
            LatticeBody body = slab(start);
            const std::vector<LossLaw> laws = make_loss_laws(body.materials, only_convection(h, 300.0));
            LossElements loss =
                make_loss_elements(body.grid, body.boundary, body.surface.elements, body.nodes);
            for (int n = 0; n < 50; ++n) {
                step(body, laws, loss, 0.0, 8e-6);
                for (std::int64_t q = 0; q < body.particles.count(); ++q) {
                    const double t = body.eos[0].temperature(
                        body.particles.specific_energy[body.particles.layout.place[q]]);
                    ASSERT_GE((t - 300.0) / (start - 300.0), -1e-9)
                        << "from " << start << " K, h " << h << ", step " << n;
                }
            }
        }
}

TEST(SurfaceLosses, one_implicit_step_converges_to_many_small_explicit_ones) {
    // One element as a body of its own: m c dT/dt = -a q(T).
    const Material steel = plain_steel();
    const std::vector<EquationOfState> eos{make_equation_of_state(steel)};
    const std::vector<LossLaw> laws = make_loss_laws({steel}, all_losses());
    const double area = plate_dx * plate_dx, mass = 0.5 * steel.density * plate_dx * plate_dx * plate_dx;
    const double time = 1e-5;
    const auto run = [&](int steps, bool implicit) {
        double e = eos[0].energy(3300.0);
        const double dt = time / steps;
        for (int n = 0; n < steps; ++n) {
            const double t = eos[0].temperature(e);
            const LossFlux flux = loss_flux(laws[0], t);
            e -= implicit ? element_loss(laws[0], eos[0], area, mass, t, 0.0, dt).total() / mass
                          : (flux.radiation + flux.evaporation) * area * dt / mass;
        }
        return eos[0].temperature(e);
    };
    const double exact = run(200000, false);
    ASSERT_LT(exact, 3100.0) << "the losses are strong";
    const double error_16 = std::abs(run(16, true) - exact), error_32 = std::abs(run(32, true) - exact);
    EXPECT_LT(error_32, 0.02 * (3300.0 - exact));
    EXPECT_NEAR(error_16 / error_32, 2.0, 0.2) << "first order";
}

TEST(SurfaceLosses, elements_lose_in_groups_what_each_loses_alone) {
    // Hot and cold ones side by side: some evaporate, some do not, some only for what they are about to gain.
    LatticeBody body = slab(300.0, 19);
    const std::vector<LossLaw> laws = make_loss_laws(body.materials, all_losses());
    for (std::int64_t q = 0; q < body.particles.count(); ++q) {
        const double t = 400.0 + 3000.0 * body.particles.position[q].x() / (19.0 * plate_dx);
        body.particles.specific_energy[body.particles.layout.place[q]] = body.eos[0].energy(t);
    }
    particles_to_grid(body.grid, body.particles, nullptr, body.nodes);
    favre_mean(body.grid, body.eos, body.boundary, body.nodes);
    const SurfaceElements& elements = body.surface.elements;
    LossElements loss = make_loss_elements(body.grid, body.boundary, elements, body.nodes);
    const double dt = 4e-6;
    std::vector<double> energy(elements.area), temperature, gain;
    for (double& e : energy)
        e *= 2e8 * dt;
    deposit(body.grid, elements, energy, body.nodes);
    const LossEnergy lost =
        deposit_losses(body.grid, body.boundary, laws, body.eos, elements, dt, loss, body.nodes);

    surface_temperatures(body.grid, elements, body.nodes, temperature);
    interpolate_to_surface(body.grid, elements, loss.gain, gain);
    LossEnergy expected;
    int evaporating = 0;
    for (std::int64_t s = 0; s < elements.count(); ++s) {
        const LossEnergy e = element_loss(laws[0], body.eos[0], elements.area[s],
                                          loss.mass[elements.layout.place[s]], temperature[s], gain[s], dt);
        expected.radiated += e.radiated;
        expected.evaporated += e.evaporated;
        evaporating += e.evaporated > 0.0;
    }
    EXPECT_GT(evaporating, 0);
    EXPECT_LT(evaporating, elements.count());
    EXPECT_NEAR(lost.radiated, expected.radiated, 1e-12 * expected.radiated);
    EXPECT_NEAR(lost.evaporated, expected.evaporated, 1e-12 * expected.evaporated);
}

TEST(SurfaceLosses, the_steady_temperature_does_not_depend_on_the_step) {
    // As much heat comes as steel at 3200 K evaporates and radiates; the bulk follows until all is at 3200 K.
    const std::vector<LossLaw> laws = make_loss_laws({plain_steel()}, all_losses());
    const LossFlux flux = loss_flux(laws[0], 3200.0);
    for (const double dt : {2e-6, 8e-6}) {
        LatticeBody body = slab(3200.0);
        LossElements loss = make_loss_elements(body.grid, body.boundary, body.surface.elements, body.nodes);
        for (int n = 0; n < int(4e-4 / dt); ++n)
            step(body, laws, loss, flux.radiation + flux.evaporation, dt);
        EXPECT_NEAR(mean_surface_temperature(body), 3200.0, 0.01) << "dt " << dt;
    }
}

TEST(SurfaceLosses, evaporation_holds_the_surface_down_without_ringing) {
    // Far more heat than conduction takes: the stiff balance settles where the flux equals the supply.
    const std::vector<LossLaw> laws = make_loss_laws({plain_steel()}, all_losses());
    LatticeBody body = slab(3000.0);
    LossElements loss = make_loss_elements(body.grid, body.boundary, body.surface.elements, body.nodes);
    double before = 0.0;
    for (int n = 0; n < 400; ++n) {
        step(body, laws, loss, 5e9, 8e-6);
        const double now = mean_surface_temperature(body);
        EXPECT_GT(now, before - 2.0) << "step " << n;
        before = now;
    }
    const LossFlux flux = loss_flux(laws[0], before);
    EXPECT_NEAR(flux.evaporation + flux.radiation, 5e9, 0.02 * 5e9);
}

} // namespace
} // namespace meltscope
