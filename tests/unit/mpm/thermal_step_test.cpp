#include "meltscope/mpm/thermal_step.hpp"

#include "meltscope/mpm/free_surface.hpp"
#include "reference/driver.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>

namespace meltscope {
namespace {

using namespace verification;

double warm_spot(const Vec3& x) {
    return 700.0 + 600.0 * std::exp(-30.0 * (x - Vec3(0.4, 0.3, 0.5)).squaredNorm());
}

Material steel_like() {
    Material m = constant_material();
    m.solidus = 1000.0;
    m.liquidus = 1060.0;
    m.latent_heat = 150.0;
    m.conductivity.solid = {{0.4, 5e-4, 0.0}};
    m.conductivity.liquid = {{0.8, 3e-4, 0.0}};
    m.heat_capacity.solid = {{0.9, 2e-4, 0.0}};
    m.heat_capacity.liquid = {{1.3, 0.0, 0.0}};
    return m;
}

/// A block with a free surface above z = 0.85, two faces of fixed temperature, a lattice below and jittered
/// points on top; heated at the surface.
struct Block {
    ThermalRun run;
    FreeSurface surface;
    double deposited = 0.0;

    Block(const std::vector<Material>& materials, const Stepping& stepping, bool fixed_faces = true)
        : run(make_run(materials, stepping, fixed_faces)),
          surface(find_free_surface(run.grid, run.particles, run.nodes, {}, true)) {}

    void advance(double duration) {
        std::vector<double> heat(surface.elements.count());
        run.advance(duration, 1.0, [&](double dt) {
            for (std::int64_t s = 0; s < surface.elements.count(); ++s) {
                heat[s] = 3e3 * dt * surface.elements.area[s] * (1.0 + surface.elements.point[s][0]);
                deposited += heat[s];
            }
            deposit(run.grid, surface.elements, heat, run.nodes);
        });
    }

    static ThermalRun make_run(const std::vector<Material>& materials, const Stepping& stepping,
                               bool fixed_faces) {
        const Grid grid = make_grid(Vec3::Zero(), 0.1, {12, 10, 11});
        std::vector<EquationOfState> eos;
        for (const Material& m : materials)
            eos.push_back(make_equation_of_state(m));
        ParticleList list = lattice_points(grid, 2, [](const Vec3& x) { return x[2] < 0.85; });
        for (std::int64_t q = 0; q < list.size(); ++q) {
            if (list.position[q][2] > 0.6)
                list.position[q] += 0.004 * Vec3(std::sin(3.0 * q), std::cos(5.0 * q), std::sin(7.0 * q));
            if (materials.size() > 1 && list.position[q][0] > 0.55)
                list.material[q] = 1;
        }
        set_state(eos, warm_spot, list);
        Boundary boundary;
        if (fixed_faces) {
            boundary[0] = {FaceCondition::Kind::fixed_temperature, 600.0, 0.0, 0.0};
            boundary[4] = {FaceCondition::Kind::fixed_temperature, 800.0, 0.0, 0.0};
        }
        return ThermalRun(grid, eos, boundary, std::move(list), 2, stepping);
    }
};

TEST(ThermalStep, change_of_the_energy_is_what_was_deposited_and_conducted) {
    for (const bool affine : {true, false})
        for (const double blend : {0.0, 0.37, 1.0})
            for (const std::size_t materials : {1u, 2u}) {
                Stepping stepping;
                stepping.affine = affine;
                stepping.blend = blend;
                std::vector<Material> used{steel_like()};
                if (materials == 2)
                    used.push_back(constant_material(0.5, 1.7, 0.8));
                Block block(used, stepping);
                block.advance(0.08);
                const double change = total_energy(block.run.particles) - block.run.start_energy;
                EXPECT_GT(std::abs(block.run.conducted), 1.0);
                EXPECT_GT(block.deposited, 100.0);
                EXPECT_NEAR((change - block.run.conducted - block.deposited) / block.run.start_energy, 0.0,
                            1e-12)
                    << "affine " << affine << ", b " << blend << ", materials " << materials;
            }
}

/// A ball that ends `gap` (in cells of 0.1) before the face x = 0, which is held at 300 K.
ThermalRun ball_beside_a_cold_face(double gap) {
    const Grid grid = make_grid(Vec3::Zero(), 0.1, {12, 12, 12});
    const Vec3 center(0.1 * gap + 0.33, 0.61, 0.58);
    ParticleList list = lattice_points(grid, 2, [&](const Vec3& x) { return (x - center).norm() < 0.33; });
    const std::vector<EquationOfState> eos{make_equation_of_state(constant_material())};
    set_state(
        eos, [](const Vec3&) { return 600.0; }, list);
    Boundary boundary;
    boundary[0] = {FaceCondition::Kind::fixed_temperature, 300.0, 0.0, 0.0};
    return ThermalRun(grid, eos, boundary, std::move(list), 2);
}

TEST(ThermalStep, heat_beside_a_fixed_face_that_the_body_does_not_reach_is_all_accounted_for) {
    // Foot points lie up to half a spacing nearer to the face than particles, so that they may see ghosts
    // which no particle sees.
    int seen = 0;
    for (const double gap : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}) {
        ThermalRun run = ball_beside_a_cold_face(gap);
        const FreeSurface surface = find_free_surface(run.grid, run.particles, run.nodes, {}, true);
        for (const Vec3& x : surface.elements.point) {
            const BinPlace bin = bin_place(run.grid, x);
            seen += bin.node[0] == 0 && run.nodes.mass[run.grid.index(-1, bin.node[1], bin.node[2])] == 0.0;
        }
        double deposited = 0.0;
        std::vector<double> heat(surface.elements.count());
        run.advance(0.02, 1.0, [&](double dt) {
            for (std::int64_t s = 0; s < surface.elements.count(); ++s)
                deposited += heat[s] = 1e4 * dt * surface.elements.area[s];
            deposit(run.grid, surface.elements, heat, run.nodes);
        });
        const double change = total_energy(run.particles) - run.start_energy;
        EXPECT_GT(deposited, 0.1 * run.start_energy);
        EXPECT_NEAR((change - run.conducted - deposited) / run.start_energy, 0.0, 1e-13) << "gap " << gap;
    }
    EXPECT_GT(seen, 0);
}

TEST(ThermalStep, a_fixed_face_beyond_the_reach_of_all_particles_is_not_seen_by_the_surface) {
    // More than a cell and a half away: no particle reaches the nodes of the face, some foot points do.
    const ThermalRun run = ball_beside_a_cold_face(1.3);
    const FreeSurface surface = find_free_surface(run.grid, run.particles, run.nodes, {}, true);
    for (std::int64_t k = 0; k <= 12; ++k)
        for (std::int64_t j = 0; j <= 12; ++j)
            ASSERT_EQ(run.nodes.mass[run.grid.index(0, j, k)], 0.0);
    double nearest = 1.0;
    for (const Vec3& x : surface.elements.point)
        nearest = std::min(nearest, x[0]);
    ASSERT_LT(nearest, 0.15);
    std::vector<double> temperature;
    surface_temperatures(run.grid, surface.elements, run.nodes, temperature);
    for (const double t : temperature)
        EXPECT_NEAR(t, 600.0, 1e-9);
}

TEST(ThermalStep, energy_form_is_the_temperature_form_for_constant_heat_capacity) {
    for (const bool affine : {true, false}) {
        Stepping by_temperature, by_energy;
        by_temperature.affine = by_energy.affine = affine;
        by_energy.energy_gradient = true;
        Material m = constant_material(0.8, 2.0, 0.7);
        m.conductivity.solid = m.conductivity.liquid = {{0.3, 4e-4, 0.0}};
        Block a({m}, by_temperature), b({m}, by_energy);
        a.advance(0.05);
        b.advance(0.05);
        for (std::size_t at = 0; at < a.run.particles.specific_energy.size(); ++at)
            ASSERT_NEAR(a.run.particles.specific_energy[at], b.run.particles.specific_energy[at], 1e-9);
    }
}

TEST(ThermalStep, uniform_temperature_stays_uniform_in_any_material) {
    for (const bool affine : {true, false}) {
        Stepping stepping;
        stepping.affine = affine;
        ThermalRun run = Block::make_run({steel_like(), constant_material(0.5, 1.7, 0.8)}, stepping, false);
        ParticleList list = list_particles(run.particles);
        set_state(
            run.materials, [](const Vec3&) { return 1030.0; }, list); // mushy
        ThermalRun uniform(run.grid, run.materials, Boundary{}, std::move(list), 2, stepping);
        uniform.advance(0.05, 1.0);
        EXPECT_NEAR(uniform.coldest_particle(), 1030.0, 1e-9);
        EXPECT_NEAR(uniform.hottest_particle(), 1030.0, 1e-9);
    }
}

TEST(ThermalStep, heat_flows_from_hot_to_cold) {
    Stepping stepping;
    Block block({constant_material()}, stepping, false);
    const double hot = block.run.hottest_particle(), cold = block.run.coldest_particle();
    block.run.advance(0.05, 1.0);
    EXPECT_LT(block.run.hottest_particle(), hot - 10.0);
    EXPECT_GT(block.run.coldest_particle(), cold - 1e-6);
}

TEST(ThermalStep, results_are_bitwise_equal_for_1_2_and_4_threads) {
    const int before = omp_get_max_threads();
    std::vector<Field> energies, temperatures, distances;
    std::vector<double> sums;
    for (const int threads : {1, 2, 4}) {
        omp_set_num_threads(threads);
        Block block({steel_like(), constant_material(0.5, 1.7, 0.8)}, Stepping{});
        block.advance(0.05);
        energies.push_back(block.run.particles.specific_energy);
        temperatures.push_back(block.run.nodes.temperature);
        distances.push_back(block.surface.phi);
        sums.push_back(block.run.conducted);
        sums.push_back(total_energy(block.run.particles));
        sums.push_back(block.deposited);
    }
    omp_set_num_threads(before);
    const auto same_bits = [](const Field& a, const Field& b) {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
    };
    for (int other : {1, 2}) {
        EXPECT_TRUE(same_bits(energies[0], energies[other]));
        EXPECT_TRUE(same_bits(temperatures[0], temperatures[other]));
        EXPECT_TRUE(same_bits(distances[0], distances[other]));
        for (int s = 0; s < 3; ++s)
            EXPECT_EQ(sums[s], sums[3 * other + s]);
    }
}

} // namespace
} // namespace meltscope
