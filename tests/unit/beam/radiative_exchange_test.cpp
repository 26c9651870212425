#include "meltscope/beam/radiative_exchange.hpp"

#include "lattice_block.hpp"

#include "meltscope/beam/surface_losses.hpp"
#include "meltscope/constants.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace meltscope {
namespace {

constexpr double spacing = 5e-6;

Material with_emissivity(double emissivity) {
    Material material = plain_steel();
    material.emissivity = emissivity;
    return material;
}

RadiativeExchange exchange_of(const LatticeBody& body) {
    return make_radiative_exchange(body.grid, body.surface, body.particles, body.materials, {});
}

/// A block with a hollow ball in it.
LatticeBody cavity(double emissivity) {
    return make_lattice_body(with_emissivity(emissivity), spacing, {24, 24, 24}, 300.0, [](const Vec3& x) {
        return (x - Vec3::Constant(12.2 * spacing)).norm() > 8.0 * spacing;
    });
}

/// Two slabs that face each other across a gap half as wide as they are.
LatticeBody facing_plates(double emissivity) {
    return make_lattice_body(with_emissivity(emissivity), spacing, {24, 24, 20}, 300.0,
                             [](const Vec3& x) { return x.z() < 4.0 * spacing || x.z() > 16.0 * spacing; });
}

LatticeBody two_balls() {
    return make_lattice_body(with_emissivity(0.4), spacing, {32, 18, 18}, 300.0, [](const Vec3& x) {
        return (x - spacing * Vec3(8.5, 9.0, 9.0)).norm() < 6.5 * spacing ||
               (x - spacing * Vec3(22.5, 9.0, 9.0)).norm() < 6.5 * spacing;
    });
}

double black_flux(double t, double ambient) {
    return constants::stefan_boltzmann * (std::pow(t, 4) - std::pow(ambient, 4));
}

TEST(RadiativeExchange, flat_plate_reabsorbs_nothing) {
    const LatticeBody body = make_lattice_body(with_emissivity(0.4), spacing, {16, 16, 10}, 300.0,
                                               [](const Vec3& x) { return x.z() < 4.3 * spacing; });
    const RadiativeExchange exchange = exchange_of(body);
    EXPECT_EQ(exchange.cost.factors, 0);
    std::vector<double> power(body.surface.elements.count(), 0.0);
    const std::vector<double> hot(power.size(), 2500.0);
    EXPECT_EQ(reabsorbed_power(exchange, body.surface.elements, hot, 300.0, power), 0.0);
}

TEST(RadiativeExchange, ball_reabsorbs_nothing) {
    const LatticeBody body =
        make_lattice_body(with_emissivity(0.4), spacing, {20, 20, 20}, 300.0, [](const Vec3& x) {
            return (x - Vec3::Constant(10.1 * spacing)).norm() < 6.0 * spacing;
        });
    EXPECT_EQ(exchange_of(body).cost.factors, 0);
}

TEST(RadiativeExchange, closed_isothermal_cavity_loses_nothing) {
    for (const double emissivity : {0.1, 0.4, 1.0}) {
        const LatticeBody body = cavity(emissivity);
        const RadiativeExchange exchange = exchange_of(body);
        EXPECT_EQ(std::accumulate(exchange.surroundings.begin(), exchange.surroundings.end(), 0.0), 0.0);
        EXPECT_EQ(exchange.cost.stray_rays, 0);
        std::vector<double> power(body.surface.elements.count(), 0.0);
        const std::vector<double> hot(power.size(), 1900.0);
        reabsorbed_power(exchange, body.surface.elements, hot, 300.0, power);
        for (std::size_t s = 0; s < power.size(); ++s) {
            const double emitted = emissivity * black_flux(1900.0, 300.0) * body.surface.elements.area[s];
            ASSERT_NEAR(power[s], emitted, 1e-12 * emitted) << "emissivity " << emissivity;
        }
    }
}

TEST(RadiativeExchange, closed_cavity_with_a_hot_spot_keeps_its_energy) {
    const LatticeBody body = cavity(0.4);
    const SurfaceElements& elements = body.surface.elements;
    std::vector<double> power(elements.count(), 0.0), temperature(elements.count());
    double emitted = 0.0;
    for (std::int64_t s = 0; s < elements.count(); ++s) {
        temperature[s] = elements.point[s].z() > 16.0 * spacing ? 2500.0 : 300.0;
        emitted += 0.4 * black_flux(temperature[s], 300.0) * elements.area[s];
    }
    EXPECT_NEAR(reabsorbed_power(exchange_of(body), elements, temperature, 300.0, power), emitted,
                1e-3 * emitted);
}

TEST(RadiativeExchange, reciprocity_holds_exactly_and_the_sum_rule_to_round_off) {
    for (const LatticeBody& body : {two_balls(), facing_plates(0.4), cavity(0.4)}) {
        const RadiativeExchange e = exchange_of(body);
        ASSERT_GT(e.cost.factors, 0);
        const auto between = [&](std::int64_t i, std::int64_t j) {
            for (std::int64_t n = e.row_start[i]; n < e.row_start[i + 1]; ++n)
                if (e.column[n] == j)
                    return e.exchange_area[n];
            return 0.0;
        };
        for (std::int64_t i = 0; i < e.cost.patches; ++i) {
            double sum = e.surroundings[i];
            for (std::int64_t n = e.row_start[i]; n < e.row_start[i + 1]; ++n) {
                EXPECT_GE(e.exchange_area[n], 0.0);
                EXPECT_EQ(e.exchange_area[n], between(e.column[n], i));
                sum += e.exchange_area[n];
            }
            EXPECT_NEAR(sum, e.area[i], 1e-12 * e.area[i]);
        }
    }
}

TEST(RadiativeExchange, facing_plates_exchange_what_their_view_factor_says) {
    // Parallel squares of side 2 H at the distance H: F = 0.41525 (Howell, catalog of configuration factors,
    // C-11).
    constexpr double view = 0.41525;
    const double area = 24 * 24 * spacing * spacing;
    for (const double emissivity : {1.0, 0.4}) {
        const LatticeBody body = facing_plates(emissivity);
        const SurfaceElements& elements = body.surface.elements;
        std::vector<double> power(elements.count(), 0.0), temperature(elements.count());
        for (std::int64_t s = 0; s < elements.count(); ++s)
            temperature[s] = elements.normal[s].z() > 0.0 ? 2000.0 : 300.0;
        reabsorbed_power(exchange_of(body), elements, temperature, 300.0, power);
        double lower = 0.0, upper = 0.0;
        for (std::int64_t s = 0; s < elements.count(); ++s)
            (elements.normal[s].z() > 0.0 ? lower : upper) += power[s];
        const double reflected = (1.0 - emissivity) * view;
        const double radiosity = emissivity * black_flux(2000.0, 300.0) / (1.0 - reflected * reflected);
        EXPECT_NEAR(upper, emissivity * view * radiosity * area, 0.02 * upper) << "emissivity " << emissivity;
        EXPECT_NEAR(lower, emissivity * view * reflected * radiosity * area, 0.05 * upper);
    }
}

TEST(RadiativeExchange, patches_of_any_size_give_the_same_exchange_between_plates) {
    const LatticeBody body = facing_plates(0.4);
    const SurfaceElements& elements = body.surface.elements;
    std::vector<double> temperature(elements.count());
    for (std::int64_t s = 0; s < elements.count(); ++s)
        temperature[s] = elements.normal[s].z() > 0.0 ? 2000.0 : 300.0;
    std::vector<double> sums;
    for (const double patch_size : {2.0, 4.0, 8.0}) {
        std::vector<double> power(elements.count(), 0.0);
        const RadiativeExchange exchange =
            make_radiative_exchange(body.grid, body.surface, body.particles, body.materials, {patch_size, 8});
        sums.push_back(reabsorbed_power(exchange, elements, temperature, 300.0, power));
    }
    EXPECT_NEAR(sums[0], sums[1], 0.02 * sums[1]);
    EXPECT_NEAR(sums[2], sums[1], 0.02 * sums[1]);
}

TEST(RadiativeExchange, nothing_is_exchanged_at_ambient) {
    const LatticeBody body = cavity(0.4);
    std::vector<double> power(body.surface.elements.count(), 0.0);
    const std::vector<double> cold(power.size(), 300.0);
    EXPECT_EQ(reabsorbed_power(exchange_of(body), body.surface.elements, cold, 300.0, power), 0.0);
}

TEST(RadiativeExchange, factors_do_not_depend_on_the_number_of_threads) {
    const LatticeBody body = two_balls();
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const RadiativeExchange one = exchange_of(body);
    omp_set_num_threads(3);
    const RadiativeExchange three = exchange_of(body);
    omp_set_num_threads(threads);
    EXPECT_EQ(one.column, three.column);
    EXPECT_EQ(one.exchange_area, three.exchange_area);
    EXPECT_EQ(one.surroundings, three.surroundings);
}

TEST(RadiativeExchange, cost_is_reported) {
    const LatticeBody body = two_balls();
    const ExchangeCost cost = exchange_of(body).cost;
    EXPECT_GT(cost.seconds, 0.0);
    EXPECT_GT(cost.patches, 10);
    EXPECT_EQ(cost.rays, 8 * body.surface.elements.count());
    EXPECT_GE(cost.bytes, cost.factors * 12);
}

TEST(RadiativeExchange, a_material_without_emissivity_is_refused) {
    LatticeBody body = two_balls();
    body.materials[0].emissivity.reset();
    EXPECT_THROW(exchange_of(body), std::invalid_argument);
}

} // namespace
} // namespace meltscope
