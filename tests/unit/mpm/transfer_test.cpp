#include "meltscope/mpm/nodes.hpp"

#include "reference/driver.hpp"

#include <gtest/gtest.h>

namespace meltscope {
namespace {

using namespace verification;

const std::vector<EquationOfState>& constant() {
    static const std::vector<EquationOfState> materials{
        make_equation_of_state(constant_material(2.0, 3.0, 1.5))};
    return materials;
}

double exact_sum(const Field& field) {
    long double sum = 0.0; // so that the test's own round-off does not show
    for (const double value : field)
        sum += value;
    return double(sum);
}

/// A slab with a free surface at z = 0.85, a little off the lattice if jittered.
Particles slab(const Grid& grid, int n, bool jittered,
               const std::function<double(const Vec3&)>& temperature) {
    ParticleList list = lattice_points(grid, n, [](const Vec3& x) { return x[2] < 0.85; });
    if (jittered)
        jitter(grid, 0.2 * grid.dx / n, list);
    set_state(constant(), temperature, list);
    return make_particles(grid, std::move(list), n);
}

const Grid& box() {
    static const Grid grid = make_grid(Vec3::Zero(), 0.1, {13, 9, 12});
    return grid;
}

TEST(Transfer, mass_and_energy_arrive_at_the_nodes_undiminished) {
    const auto uneven = [](const Vec3& x) {
        return 800.0 + 300.0 * std::sin(9.0 * x[0]) * std::cos(7.0 * x[2]);
    };
    for (const int n : {1, 2, 3, 4})
        for (const bool jittered : {false, true}) {
            const Particles particles = slab(box(), n, jittered, uneven);
            Nodes nodes = make_nodes(box(), particles, 1, Boundary{});
            EXPECT_NEAR(exact_sum(nodes.mass) / exact_sum(particles.mass), 1.0, 1e-13);
            std::vector<Field> gradient_of{Field(box().size)};
            for (std::size_t i = 0; i < gradient_of[0].size(); ++i)
                gradient_of[0][i] = 500.0 * std::sin(double(i));
            particles_to_grid(box(), particles, nullptr, nodes);
            EXPECT_NEAR(exact_sum(nodes.mass_energy) / total_energy(particles), 1.0, 1e-13);
            particles_to_grid(box(), particles, &gradient_of, nodes);
            EXPECT_NEAR(exact_sum(nodes.mass_energy) / total_energy(particles), 1.0, 1e-13)
                << "whatever the gradients";
        }
}

/// e_i - e(x_i) relative to the range of the field at nodes with mass, `margin` cells off the walls (not the
/// surface).
double affine_error(const Particles& particles, const std::function<double(const Vec3&)>& temperature,
                    int margin, double top, bool with_gradient) {
    const Grid& grid = box();
    Nodes nodes = make_nodes(grid, particles, 1, Boundary{});
    std::vector<Field> exact{Field(grid.size, 0.0)};
    for (std::int64_t k = -1; k <= grid.cells[2] + 1; ++k)
        for (std::int64_t j = -1; j <= grid.cells[1] + 1; ++j)
            for (std::int64_t i = -1; i <= grid.cells[0] + 1; ++i)
                exact[0][grid.index(i, j, k)] = constant()[0].energy(temperature(grid.position(i, j, k)));
    particles_to_grid(grid, particles, with_gradient ? &exact : nullptr, nodes);
    favre_mean(grid, constant(), Boundary{}, nodes);
    double most = 0.0;
    std::int64_t compared = 0;
    for (std::int64_t k = margin; k <= grid.cells[2]; ++k)
        for (std::int64_t j = margin; j <= grid.cells[1] - margin; ++j)
            for (std::int64_t i = margin; i <= grid.cells[0] - margin; ++i) {
                const std::int64_t at = grid.index(i, j, k);
                if (nodes.mass[at] <= 0.0 || grid.position(i, j, k)[2] > top)
                    continue;
                most = std::max(most, std::abs(nodes.temperature[at] - temperature(grid.position(i, j, k))));
                ++compared;
            }
    EXPECT_GT(compared, 100);
    return most;
}

TEST(Transfer, affine_carries_a_linear_field_exactly_also_beyond_the_free_surface) {
    const auto linear = [](const Vec3& x) { return 900.0 + 200.0 * x[0] - 150.0 * x[1] + 300.0 * x[2]; };
    for (const int n : {1, 2, 3})
        for (const bool jittered : {false, true}) {
            const Particles particles = slab(box(), n, jittered, linear);
            EXPECT_LT(affine_error(particles, linear, 2, 1e9, true), 1e-9);
            EXPECT_GT(affine_error(particles, linear, 2, 1e9, false), 1.0) << "which values alone do not";
        }
}

TEST(Transfer, quadratic_field_is_reproduced_between_the_nodes) {
    const auto quadratic = [](const Vec3& x) {
        return 900.0 + 400.0 * x[0] * x[0] - 200.0 * x[0] * x[1] + 300.0 * x[2] * x[2] - 100.0 * x[1] * x[2];
    };
    const Grid& grid = box();
    const Particles particles = slab(grid, 2, false, quadratic);
    Nodes nodes = make_nodes(grid, particles, 1, Boundary{});
    std::vector<Field> shape{Field(grid.size, 0.0)}; // gives the particles their gradient
    for (std::int64_t k = -1; k <= grid.cells[2] + 1; ++k)
        for (std::int64_t j = -1; j <= grid.cells[1] + 1; ++j)
            for (std::int64_t i = -1; i <= grid.cells[0] + 1; ++i)
                shape[0][grid.index(i, j, k)] = constant()[0].energy(quadratic(grid.position(i, j, k)));
    particles_to_grid(grid, particles, &shape, nodes);
    favre_mean(grid, constant(), Boundary{}, nodes);
    for (const Vec3& x : {Vec3(0.5, 0.5, 0.5), Vec3(0.63, 0.42, 0.47), Vec3(0.711, 0.555, 0.432)})
        EXPECT_NEAR(interpolate(grid, nodes.temperature, x), quadratic(x), 1e-9);
}

TEST(Transfer, node_without_mass_has_no_temperature) {
    const Particles particles = slab(box(), 2, false, [](const Vec3&) { return 500.0; });
    Nodes nodes = make_nodes(box(), particles, 1, Boundary{});
    particles_to_grid(box(), particles, nullptr, nodes);
    favre_mean(box(), constant(), Boundary{}, nodes);
    for (std::int64_t k = 0; k <= box().cells[2]; ++k) {
        const std::int64_t at = box().index(5, 5, k);
        EXPECT_EQ(nodes.mass[at] > 0.0, k <= 9);
        EXPECT_NEAR(nodes.temperature[at], k <= 9 ? 500.0 : 0.0, 1e-9) << k;
    }
}

TEST(Ghosts, folding_moves_what_lies_beyond_a_wall_to_its_mirror_and_keeps_the_sum) {
    const Grid grid = make_grid(Vec3::Zero(), 1.0, {5, 4, 3});
    Field field(grid.size, 0.0);
    field[grid.index(-1, 2, 1)] = 1.0;
    field[grid.index(-1, -1, -1)] = 2.0;
    field[grid.index(6, 5, 4)] = 3.0;
    fold_ghosts(grid, Boundary{}, AtFixedFaces::leave, field);
    EXPECT_EQ(field[grid.index(1, 2, 1)], 1.0);
    EXPECT_EQ(field[grid.index(1, 1, 1)], 2.0);
    EXPECT_EQ(field[grid.index(4, 3, 2)], 3.0);
    EXPECT_EQ(exact_sum(field), 6.0);

    Boundary fixed;
    fixed[0] = {FaceCondition::Kind::fixed_temperature, 300.0, 0.0, 0.0};
    for (const auto& [how, mirror, ghost] : {std::tuple(AtFixedFaces::leave, 5.0, 2.0),
                                             {AtFixedFaces::odd, 3.0, 0.0},
                                             {AtFixedFaces::even, 7.0, 0.0}}) {
        Field at_fixed(grid.size, 0.0);
        at_fixed[grid.index(-1, 2, 2)] = 2.0;
        at_fixed[grid.index(1, 2, 2)] = 5.0;
        fold_ghosts(grid, fixed, how, at_fixed);
        EXPECT_EQ(at_fixed[grid.index(1, 2, 2)], mirror);
        EXPECT_EQ(at_fixed[grid.index(-1, 2, 2)], ghost);
    }
}

TEST(Ghosts, mirroring_copies_the_inside_also_at_edges_and_corners) {
    const Grid grid = make_grid(Vec3::Zero(), 1.0, {5, 4, 3});
    Field field(grid.size, 0.0);
    const auto value = [](std::int64_t i, std::int64_t j, std::int64_t k) {
        return double(100 * i + 10 * j + k);
    };
    for (std::int64_t k = 0; k <= 3; ++k)
        for (std::int64_t j = 0; j <= 4; ++j)
            for (std::int64_t i = 0; i <= 5; ++i)
                field[grid.index(i, j, k)] = value(i, j, k);
    mirror_ghosts(grid, Boundary{}, field);
    EXPECT_EQ(field[grid.index(-1, 2, 2)], value(1, 2, 2));
    EXPECT_EQ(field[grid.index(6, 2, 2)], value(4, 2, 2));
    EXPECT_EQ(field[grid.index(-1, 5, 2)], value(1, 3, 2));
    EXPECT_EQ(field[grid.index(-1, -1, 4)], value(1, 1, 2));
}

TEST(FixedFaces, nodes_on_a_face_have_its_temperature_and_ghosts_continue_it_everywhere) {
    const Grid grid = make_grid(Vec3::Zero(), 0.1, {10, 6, 6});
    Boundary boundary;
    boundary[0] = {FaceCondition::Kind::fixed_temperature, 400.0, 0.0, 0.0};
    ParticleList list = lattice_points(grid, 2, everywhere);
    set_state(
        constant(), [](const Vec3&) { return 300.0; }, list);
    const Particles particles = make_particles(grid, std::move(list), 2);
    Nodes nodes = make_nodes(grid, particles, 1, boundary);
    particles_to_grid(grid, particles, nullptr, nodes);
    favre_mean(grid, constant(), boundary, nodes);
    for (const std::int64_t j : {-1, 0, 3, 6, 7})
        for (const std::int64_t k : {-1, 0, 3, 6, 7}) {
            EXPECT_NEAR(nodes.temperature[grid.index(0, j, k)], 400.0, 1e-12) << j << ' ' << k;
            EXPECT_NEAR(nodes.temperature[grid.index(-1, j, k)], 500.0, 1e-9) << j << ' ' << k;
            EXPECT_NEAR(nodes.temperature[grid.index(1, j, k)], 300.0, 1e-9) << j << ' ' << k;
        }
}

TEST(Mixture, materials_at_one_node_share_one_temperature_and_keep_their_energy) {
    Material melting = constant_material(1.0, 1.0, 2.0);
    melting.solidus = 900.0;
    melting.liquidus = 950.0;
    melting.latent_heat = 500.0;
    const std::vector<EquationOfState> materials{make_equation_of_state(constant_material(1.0, 1.0, 1.0)),
                                                 make_equation_of_state(melting)};
    const std::vector<Field> mass{Field(1, 2.0), Field(1, 3.0)};
    for (double t = 200.0; t < 2000.0; t += 17.0) {
        const double total = 2.0 * materials[0].energy(t) + 3.0 * materials[1].energy(t);
        EXPECT_NEAR(mixture_temperature(materials, mass, 0, total), t, 1e-8);
    }
    // constant heat capacities: the capacity-weighted mean, 2 x 1 x 300 K and 3 x 2 x 700 K
    const double total = 2.0 * materials[0].energy(300.0) + 3.0 * materials[1].energy(700.0);
    EXPECT_NEAR(mixture_temperature(materials, mass, 0, total), (2.0 * 300.0 + 6.0 * 700.0) / 8.0, 1e-9);
}

} // namespace
} // namespace meltscope
