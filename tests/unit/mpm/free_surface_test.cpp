#include "meltscope/mpm/free_surface.hpp"

#include "meltscope/beam/illumination.hpp"
#include "meltscope/beam/profile.hpp"
#include "reference/driver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <numeric>

namespace meltscope {
namespace {

using namespace verification;

/// Particles where `inside`, on a grid of spacing one, with nodes and surface.
struct Body {
    Grid grid;
    Particles particles;
    Nodes nodes;
    FreeSurface surface;
};

Body make_body(const Index3& cells, const std::function<bool(const Vec3&)>& inside, bool at_surface = true) {
    Body body;
    body.grid = make_grid(Vec3::Zero(), 1.0, cells);
    ParticleList list = lattice_points(body.grid, 2, inside);
    list.mass = list.volume;
    body.particles = make_particles(body.grid, std::move(list), 2);
    body.nodes = make_nodes(body.grid, body.particles, 1, Boundary{});
    body.surface = find_free_surface(body.grid, body.particles, body.nodes, {}, at_surface);
    return body;
}

/// A plate whose upper face is tilted about y by `degrees`; the beam comes down at (20, 20).
Body tilted_plate(double degrees) {
    const double slope = std::tan(degrees * std::numbers::pi / 180.0);
    return make_body({40, 40, 28}, [=](const Vec3& x) { return x[2] < 14.1 + slope * (x[0] - 20.0); });
}

Laser beam(double spot_radius) {
    Laser laser;
    laser.power = 200.0;
    laser.absorptivity = 0.4;
    laser.spot_radius = spot_radius;
    return laser;
}

double sum_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(LevelSet, flat_face_of_a_lattice_lies_half_a_spacing_above_its_top_particles) {
    for (const double top : {6.0, 6.5}) {
        const Body body = make_body({8, 8, 14}, [=](const Vec3& x) { return x[2] < top; });
        for (std::int64_t k = 3; k <= 10; ++k)
            EXPECT_NEAR(body.surface.phi[body.grid.index(4, 4, k)], double(k) - top, 0.01) << "top " << top;
    }
}

TEST(LevelSet, body_that_fills_the_box_has_no_free_surface) {
    const Body body = make_body({8, 8, 8}, everywhere);
    EXPECT_EQ(body.surface.elements.count(), 0);
    for (std::int64_t k = 0; k <= 8; ++k)
        EXPECT_LT(body.surface.phi[body.grid.index(0, 4, k)], -level_set_band + 1e-9);
}

TEST(LevelSet, groups_that_are_left_out_because_they_are_full_change_nothing) {
    // Laid out as if there were no lattice, no group is known to be full and none is left out. Of round
    // bodies at round places round-off alone would decide which of two feet is the nearer.
    const Grid grid = make_grid(Vec3::Zero(), 1.0, {21, 19, 23});
    for (const int n : {1, 2, 3}) {
        ParticleList list = lattice_points(grid, n, [](const Vec3& x) {
            return x[2] < 14.0 && (x - Vec3(10.13, 9.07, 14.21)).norm() > 5.03 && // a bowl in a block,
                   (x - Vec3(17.11, 3.29, 6.37)).norm() > 2.17;                   // and a pore
        });
        list.mass = list.volume;
        const Field expected = signed_distance(grid, make_particles(grid, list, 0), {});
        const Field phi = signed_distance(grid, make_particles(grid, list, n), {});
        double largest = 0.0;
        for (std::int64_t k = 0; k <= 23; ++k)
            for (std::int64_t j = 0; j <= 19; ++j)
                for (std::int64_t i = 0; i <= 21; ++i)
                    largest =
                        std::max(largest, std::abs(phi[grid.index(i, j, k)] - expected[grid.index(i, j, k)]));
        EXPECT_LT(largest, 1e-12) << n << " points a cell along an axis";
    }
}

TEST(LevelSet, regularised_level_set_runs_from_minus_to_plus_one_half) {
    const Body body = make_body({8, 8, 16}, [](const Vec3& x) { return x[2] < 8.0; });
    const Field phi_hat = regularized(body.grid, body.surface.phi, {});
    EXPECT_NEAR(phi_hat[body.grid.index(4, 4, 2)], -0.5, 1e-4);
    EXPECT_NEAR(phi_hat[body.grid.index(4, 4, 8)], 0.0, 1e-6);
    EXPECT_NEAR(phi_hat[body.grid.index(4, 4, 14)], 0.5, 1e-4);
    const double one_off = 0.5 - 1.0 / (1.0 + std::exp(1.0 / 0.5)); // phi = dx, eps = dx/2
    EXPECT_NEAR(phi_hat[body.grid.index(4, 4, 9)], one_off, 1e-6);
}

TEST(LevelSet, distance_inverts_the_smoothed_half_space) {
    // the fraction at distance x outside: the B-spline's integral from x on
    for (double x = -1.4; x <= 1.4; x += 0.1) {
        double fraction = 0.0;
        const int n = 4000;
        for (int i = 0; i < n; ++i) {
            const double u = x + (1.5 - x) * (i + 0.5) / n, a = std::abs(u);
            fraction += (a <= 0.5   ? 0.75 - a * a
                         : a <= 1.5 ? 0.5 * (1.5 - a) * (1.5 - a)
                                    : 0.0) *
                        (1.5 - x) / n;
        }
        EXPECT_NEAR(distance_of_fraction(fraction), x, 1e-4);
    }
}

TEST(LevelSet, lone_particle_is_a_small_ball) {
    const Vec3 lone(6.25, 6.25, 12.25);
    const Body body =
        make_body({12, 12, 16}, [&](const Vec3& x) { return x[2] < 6.0 || (x - lone).norm() < 0.1; });
    EXPECT_LT(interpolate(body.grid, body.surface.phi, lone), 0.7);
    EXPECT_NEAR(body.surface.phi[body.grid.index(6, 6, 12)], std::sqrt(3.0) * 0.25 - 0.25, 1e-9)
        << "distance to a ball of half a spacing";
}

TEST(SurfaceElements, normals_point_out_and_feet_lie_on_the_surface) {
    const Vec3 centre(9.3, 8.9, 9.1);
    const Body body = make_body({18, 18, 18}, [&](const Vec3& x) { return (x - centre).norm() < 6.0; });
    ASSERT_GT(body.surface.elements.count(), 500);
    for (std::int64_t s = 0; s < body.surface.elements.count(); ++s) {
        const Vec3 outward = (body.surface.elements.point[s] - centre).normalized();
        EXPECT_GT(body.surface.elements.normal[s].dot(outward), 0.95);
        EXPECT_NEAR((body.surface.elements.point[s] - centre).norm(), 6.0, 0.3);
        EXPECT_GT(body.surface.elements.area[s], 0.0);
    }
}

TEST(Deposit, what_is_deposited_arrives_exactly) {
    for (const bool at_surface : {true, false}) {
        Body body = make_body(
            {18, 18, 18}, [](const Vec3& x) { return (x - Vec3(9.3, 8.9, 9.1)).norm() < 6.0; }, at_surface);
        std::vector<double> energy(body.surface.elements.count());
        for (std::size_t s = 0; s < energy.size(); ++s)
            energy[s] = 1.0 + std::sin(double(s));
        deposit(body.grid, body.surface.elements, energy, body.nodes);
        double arrived = 0.0;
        for (std::size_t i = 0; i < body.nodes.increment.size(); ++i)
            if (body.nodes.mass[i] > 0.0)
                arrived += body.nodes.increment[i];
        EXPECT_NEAR(arrived / sum_of(energy), 1.0, 1e-13) << "at nodes with mass";
    }
}

TEST(Deposit, heat_of_some_elements_goes_where_it_goes_as_heat_of_all) {
    for (const std::int64_t every : {3, 50}) { // in turn enough to be laid out over all, and a few
        Body body = make_body({21, 14, 16}, [](const Vec3& x) { return x[2] < 8.0 + 0.2 * x[0]; });
        const std::int64_t count = body.surface.elements.count();
        std::vector<double> all(count, 0.0);
        ElementHeat some;
        for (std::int64_t s = 0; s < count; s += every) {
            all[s] = 1.0 + double(s % 7);
            some.element.push_back(s);
            some.amount.push_back(all[s]);
        }
        Nodes nodes = body.nodes;
        deposit(body.grid, body.surface.elements, all, body.nodes);
        deposit(body.grid, body.surface.elements, some, nodes);
        for (std::int64_t i = 0; i < body.grid.size; ++i)
            EXPECT_NEAR(nodes.increment[i], body.nodes.increment[i], 1e-13) << "every " << every;
    }
}

TEST(Deposit, surface_temperature_is_that_of_the_nodes_below) {
    Body body = make_body({8, 8, 14}, [](const Vec3& x) { return x[2] < 6.5; });
    for (std::int64_t k = 0; k <= 14; ++k)
        for (std::int64_t j = -1; j <= 9; ++j)
            for (std::int64_t i = -1; i <= 9; ++i) {
                const std::int64_t at = body.grid.index(i, j, k);
                body.nodes.temperature[at] = body.nodes.mass[body.grid.index(4, 4, k)] > 0.0 ? 900.0 : 0.0;
            }
    std::vector<double> temperature;
    surface_temperatures(body.grid, body.surface.elements, body.nodes, temperature);
    for (const double t : temperature)
        EXPECT_NEAR(t, 900.0, 1e-9);
}

TEST(Illumination, tilted_plate_absorbs_the_whole_beam_with_a_scale_near_one) {
    for (const double degrees : {0.0, 20.0, 35.0}) {
        const Body body = tilted_plate(degrees);
        const LightMap map = make_light_map(body.grid, body.surface, Vec3(0, 0, -1));
        const Laser laser = beam(6.0);
        ElementHeat power;
        const Absorption a = absorb(map, laser, Vec3(20, 20, 0), laser.power, body.surface.elements, power);
        EXPECT_NEAR(a.absorbed, 0.4 * 200.0, 1e-9) << degrees << " degrees";
        EXPECT_NEAR(a.missed, 0.0, 1e-9);
        EXPECT_NEAR(sum_of(power.amount), a.absorbed, 1e-10);
        EXPECT_GT(a.scale, 0.9) << degrees << " degrees";
        EXPECT_LT(a.scale, 1.1) << degrees << " degrees";
        // the centre of what it absorbs is the centre of the beam
        Vec3 centre = Vec3::Zero();
        for (std::size_t n = 0; n < power.element.size(); ++n)
            centre += power.amount[n] / a.absorbed * body.surface.elements.point[power.element[n]];
        EXPECT_NEAR(centre[0], 20.0, 0.3);
        EXPECT_NEAR(centre[1], 20.0, 0.3);
    }
}

TEST(Illumination, every_lit_element_that_the_beam_reaches_absorbs_and_no_other) {
    const Body body = tilted_plate(20.0);
    const Laser laser = beam(3.0);
    const double cutoff = cutoff_radius(laser);
    for (const Vec3& direction : {Vec3(0, 0, -1), Vec3(0.3, -0.2, -1).normalized()}) {
        const LightMap map = make_light_map(body.grid, body.surface, direction);
        for (const Vec3& position :
             {Vec3(20, 20, 14), Vec3(13.3, 24.8, 12), Vec3(1, 39, 8), Vec3(41, 20, 22)}) {
            std::vector<std::int64_t> reached;
            for (std::int64_t s = 0; s < body.surface.elements.count(); ++s)
                if (map.lit[s] && direction.cross(body.surface.elements.point[s] - position).norm() < cutoff)
                    reached.push_back(s);
            ElementHeat power;
            absorb(map, laser, position, laser.power, body.surface.elements, power);
            std::sort(power.element.begin(), power.element.end());
            EXPECT_GT(reached.size(), 20u);
            EXPECT_TRUE(
                std::equal(reached.begin(), reached.end(), power.element.begin(), power.element.end()))
                << "beam at " << position.transpose() << ": " << power.element.size() << " of "
                << reached.size();
        }
    }
}

TEST(Illumination, light_beside_the_body_is_missed) {
    // half of the beam falls on a table whose edge runs through its axis
    const Body body = make_body({32, 20, 16}, [](const Vec3& x) { return x[2] < 8.0 && x[0] < 16.0; });
    const LightMap map = make_light_map(body.grid, body.surface, Vec3(0, 0, -1));
    const Laser laser = beam(5.0);
    ElementHeat power;
    const Absorption a = absorb(map, laser, Vec3(16, 10, 0), laser.power, body.surface.elements, power);
    EXPECT_NEAR(a.missed, 0.5 * laser.power, 0.04 * laser.power);
    EXPECT_NEAR(a.absorbed + 0.4 * a.missed, 0.4 * laser.power, 1e-9);
}

TEST(Illumination, what_lies_in_the_shadow_of_another_body_stays_dark) {
    const auto roof = [](const Vec3& x) { return x[2] > 14.0 && x[2] < 18.0 && x[0] < 16.0; };
    const Body body = make_body({32, 12, 24}, [&](const Vec3& x) { return x[2] < 6.0 || roof(x); });
    const LightMap map = make_light_map(body.grid, body.surface, Vec3(0, 0, -1));
    std::int64_t dark = 0, lit = 0;
    for (std::int64_t s = 0; s < body.surface.elements.count(); ++s) {
        const Vec3& x = body.surface.elements.point[s];
        const bool faces_up = body.surface.elements.normal[s][2] > 0.9;
        if (x[2] < 7.0 && x[0] < 14.0) {
            EXPECT_FALSE(map.lit[s]) << "floor below the roof";
            ++dark;
        }
        if (faces_up && ((x[2] < 7.0 && x[0] > 18.0) || (x[2] > 17.0 && x[0] < 14.0))) {
            EXPECT_TRUE(map.lit[s]) << "open floor and the roof's top";
            ++lit;
        }
        if (body.surface.elements.normal[s][2] < 0.0) {
            EXPECT_FALSE(map.lit[s]) << "faces away";
        }
    }
    EXPECT_GT(dark, 100);
    EXPECT_GT(lit, 100);
}

TEST(Illumination, beam_that_is_off_gives_nothing) {
    const Body body = tilted_plate(0.0);
    const LightMap map = make_light_map(body.grid, body.surface, Vec3(0, 0, -1));
    ElementHeat power;
    const Absorption a = absorb(map, beam(8.0), Vec3(20, 20, 0), 0.0, body.surface.elements, power);
    EXPECT_EQ(a.absorbed, 0.0);
    EXPECT_TRUE(power.element.empty());
}

} // namespace
} // namespace meltscope
