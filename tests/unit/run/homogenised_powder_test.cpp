#include "block.hpp"

#include "meltscope/constants.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace meltscope {
namespace {

/// The block with its floor held at a temperature, K.
Simulation on_a_hot_floor(double temperature, double packing) {
    const Grid grid = test::block_grid({4, 4, 16});
    RunParameters parameters = test::block_parameters();
    parameters.boundary[4] = {FaceCondition::Kind::fixed_temperature, temperature, 0.0, 0.0};
    const double height = double(grid.cells[2]) * grid.dx;
    return make_simulation(parameters, grid, test::block_particles(grid, height, 300.0, packing), 2);
}

void run_to(Simulation& s, double time) {
    while (s.time < time)
        advance(s, time);
}

std::int64_t powder_left(const Simulation& s) {
    const ParticleList list = list_particles(s.particles);
    return std::count(list.powder.begin(), list.powder.end(), 1);
}

double temperature_at_height(const Simulation& s, std::int64_t k) {
    return s.nodes.temperature[s.grid.index(2, 2, k)];
}

TEST(HomogenisedPowder, conducts_with_its_own_conductivity_and_density) {
    // alpha = kappa/(rho c), with half the bulk's density; the profile is T_0 + (T_wall - T_0) erfc(x/sqrt(4
    // alpha t)).
    const double alpha = 0.5 / (0.5 * 8000.0 * 500.0), time = 1e-2;
    Simulation s = on_a_hot_floor(1000.0, 0.5);
    run_to(s, time);
    for (const std::int64_t k : {1, 2, 4, 6, 8}) {
        const double exact = 300.0 + 700.0 * std::erfc(double(k) * s.grid.dx / std::sqrt(4.0 * alpha * time));
        EXPECT_NEAR(temperature_at_height(s, k), exact, 0.005 * 700.0) << k;
    }
    EXPECT_EQ(powder_left(s), s.particles.count());
}

TEST(HomogenisedPowder, takes_up_heat_as_it_should_even_where_its_profile_is_two_cells_wide) {
    // Heat through the hot floor per area: 2 (T_wall - T_0) sqrt(kappa rho c t/pi). So narrow a profile takes
    // up 12 % too much even without any blend; a blend as fast as the bulk conducts makes that 40 %.
    const double kappa = 0.5, rho = 0.5 * 8000.0, c = 500.0;
    for (const double width : {2.0, 4.0}) { // sqrt(4 alpha t) in cells
        Simulation s = on_a_hot_floor(1000.0, 0.5);
        const double time = std::pow(width * s.grid.dx, 2) * rho * c / (4.0 * kappa);
        const double before = total_energy(s.particles);
        run_to(s, time);
        const double exact = 2.0 * 700.0 * std::sqrt(kappa * rho * c * time / constants::pi);
        const double taken_up = (total_energy(s.particles) - before) / std::pow(4.0 * s.grid.dx, 2);
        EXPECT_NEAR(taken_up, exact, (width < 3.0 ? 0.12 : 0.04) * exact) << width << " cells";
    }
}

TEST(HomogenisedPowder, stays_as_warm_as_it_was_below_a_hot_roof) {
    // Bulk at 1600 K on powder at 300 K: what the powder conducts is two cells wide, as in a build.
    const Grid grid = test::block_grid({4, 4, 16});
    const double height = double(grid.cells[2]) * grid.dx;
    ParticleList list = test::block_particles(grid, height, 300.0, 0.5);
    const EquationOfState eos = make_equation_of_state(test::steel());
    for (std::int64_t q = 0; q < list.size(); ++q)
        if (list.position[q][2] > 0.5 * height) {
            list.mass[q] *= 2.0;
            list.powder[q] = 0;
            list.specific_energy[q] = eos.energy(1600.0);
        }
    Simulation s = make_simulation(test::block_parameters(), grid, list, 2);
    run_to(s, 4e-4);
    EXPECT_LT(s.dt, 1e-5);
    EXPECT_GT(s.coldest_temperature, 300.0 - 0.005 * 1300.0);
}

TEST(HomogenisedPowder, turns_to_bulk_when_it_melts_and_stays_bulk) {
    Simulation s = on_a_hot_floor(2500.0, 0.5);
    run_to(s, 1e-3);
    const std::int64_t left = powder_left(s);
    ASSERT_LT(left, s.particles.count());
    ASSERT_GT(left, 0);
    s.parameters.boundary[4].temperature = 400.0;
    update_boundary(s);
    run_to(s, 1.1e-3);
    ASSERT_LT(temperature_at_height(s, 1), s.eos[0].liquidus);
    const std::int64_t after_cooling = powder_left(s);
    run_to(s, 1.3e-3);
    EXPECT_LE(after_cooling, left);
    EXPECT_LE(powder_left(s), after_cooling); // never back
    const ParticleList list = list_particles(s.particles);
    for (std::int64_t q = 0; q < list.size(); ++q) {
        if (list.position[q][2] < 0.5 * s.grid.dx) {
            EXPECT_EQ(list.powder[q], 0);
        }
    }
}

TEST(HomogenisedPowder, molten_powder_sets_the_step_by_its_low_density) {
    StepLimit limit;
    const Simulation powder = on_a_hot_floor(1000.0, 0.5), bulk = on_a_hot_floor(1000.0, 0.0);
    EXPECT_NEAR(largest_step(powder, limit), 0.5 * largest_step(bulk, limit), 1e-12);
}

TEST(HomogenisedPowder, keeps_the_energy_when_it_melts) {
    Simulation s = on_a_hot_floor(2500.0, 0.5);
    run_to(s, 1e-3);
    balance(s);
    EXPECT_LT(std::abs(s.ledger.relative_residual()), 1e-12);
}

TEST(HomogenisedPowder, survives_listing_and_adding_of_particles) {
    Simulation s = test::steel_block(0.5);
    ASSERT_TRUE(s.particles.powder.empty());
    ParticleList all = test::block_particles(s.grid, 1.0, 300.0, 0.5);
    ParticleList upper;
    for (std::int64_t q = 0; q < all.size(); ++q)
        if (all.position[q][2] > 40e-6) {
            upper.position.push_back(all.position[q]);
            upper.mass.push_back(all.mass[q]);
            upper.volume.push_back(all.volume[q]);
            upper.specific_energy.push_back(all.specific_energy[q]);
            upper.id.push_back(s.particles.count() + upper.size() - 1);
            upper.material.push_back(0);
            upper.powder.push_back(1);
        }
    const std::int64_t before = s.particles.count();
    add_particles(s, upper);
    const ParticleList list = list_particles(s.particles);
    ASSERT_EQ(std::int64_t(list.powder.size()), before + upper.size());
    for (std::int64_t q = 0; q < list.size(); ++q)
        EXPECT_EQ(int(list.powder[q]), q < before ? 0 : 1);
}

} // namespace
} // namespace meltscope
