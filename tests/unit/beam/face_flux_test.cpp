#include "meltscope/mpm/face_flux.hpp"

#include "lattice_block.hpp"

#include "meltscope/constants.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace meltscope {
namespace {

constexpr double slab_dx = 10e-6;
constexpr double diffusivity = 25.0 / (8000.0 * 600.0); // of plain_steel, m^2/s

FaceCondition flux_of(double flux) {
    FaceCondition face;
    face.kind = FaceCondition::Kind::fixed_flux;
    face.flux = flux;
    return face;
}

FaceCondition convection_of(double h, double ambient) {
    FaceCondition face;
    face.kind = FaceCondition::Kind::convection;
    face.coefficient = h;
    face.temperature = ambient;
    return face;
}

LatticeBody full_box(const Index3& cells, double temperature, const Boundary& boundary) {
    return make_lattice_body(
        plain_steel(), slab_dx, cells, temperature, [](const Vec3&) { return true; }, boundary);
}

/// One step without surface sources; energies in J through the faces.
std::array<double, 6> step(LatticeBody& body, double dt) {
    diffuse(body.grid, body.particles, body.eos, body.options, dt, body.nodes);
    const std::array<double, 6> in = deposit_face_fluxes(body.grid, body.boundary, body.eos, dt, body.nodes);
    body.finish_step(dt);
    return in;
}

/// Temperature at (x, y, z) = (m slab_dx, 0, 0): weights 1/8, 3/4, 1/8 of the nodes along x; the rest is
/// even.
double temperature_on_axis(const LatticeBody& body, std::int64_t m) {
    const auto t = [&](std::int64_t i) { return body.nodes.temperature[body.grid.index(i, 1, 1)]; };
    return 0.75 * t(m) + 0.125 * (t(m - 1) + t(m + 1));
}

TEST(FaceFlux, constant_flux_heats_a_half_space_as_erfc_says) {
    Boundary boundary;
    const double q = 2e8;
    boundary[0] = flux_of(q);
    LatticeBody body = full_box({80, 2, 2}, 300.0, boundary);
    body.options.blend = 0.3;
    const double dt = 0.3 * slab_dx * slab_dx / diffusivity;
    for (int n = 0; n < 400; ++n)
        step(body, dt);
    const double t = 400 * dt, length = std::sqrt(diffusivity * t);
    const double at_face = 2.0 * q / 25.0 * length / std::sqrt(constants::pi);
    for (const std::int64_t m : {0, 2, 5, 10, 20}) {
        const double x = double(m) * slab_dx;
        const double expected =
            2.0 * q / 25.0 * length / std::sqrt(constants::pi) * std::exp(-x * x / (4.0 * diffusivity * t)) -
            q * x / 25.0 * std::erfc(x / (2.0 * length));
        EXPECT_NEAR(temperature_on_axis(body, m) - 300.0, expected, 0.02 * at_face) << "node " << m;
    }
}

TEST(FaceFlux, convection_cools_a_slab_by_its_first_eigenmode) {
    // Slab of thickness L, adiabatic at x = L, h at x = 0: T - T_amb = cos(z (1 - x/L)) exp(-z^2 Fo), z tan z
    // = Bi = 1.
    constexpr double z = 0.8603335890193797;
    const int cells = 40;
    const double length = cells * slab_dx;
    Boundary boundary;
    boundary[0] = convection_of(25.0 / length, 300.0);
    LatticeBody body = full_box({cells, 2, 2}, 300.0, boundary);
    for (std::int64_t q = 0; q < body.particles.count(); ++q) {
        const double x = body.particles.position[q].x();
        body.particles.specific_energy[body.particles.layout.place[q]] =
            body.eos[0].energy(300.0 + 1000.0 * std::cos(z * (1.0 - x / length)));
    }
    particles_to_grid(body.grid, body.particles, nullptr, body.nodes);
    favre_mean(body.grid, body.eos, boundary, body.nodes);
    body.options.blend = 0.3;
    const double ambient_energy = 300.0 * 600.0 * 8000.0 * length * 4.0 * slab_dx * slab_dx;
    const double start = total_energy(body.particles) - ambient_energy;
    const double time = 0.7 * length * length / diffusivity, dt = 0.3 * slab_dx * slab_dx / diffusivity;
    const int steps = int(std::ceil(time / dt));
    double in = 0.0;
    for (int n = 0; n < steps; ++n)
        in += step(body, time / steps)[0];
    const double decay = std::exp(-z * z * 0.7);
    EXPECT_NEAR((total_energy(body.particles) - ambient_energy) / start, decay, 0.01 * decay);
    EXPECT_NEAR(temperature_on_axis(body, cells) - 300.0, 1000.0 * decay, 0.01 * 1000.0 * decay);
    EXPECT_NEAR(total_energy(body.particles) - ambient_energy - start, in, 1e-11 * start);
}

TEST(FaceFlux, a_body_that_covers_part_of_a_face_gets_the_area_that_it_covers) {
    Boundary boundary;
    boundary[4] = flux_of(1e8);
    LatticeBody body = make_lattice_body(
        plain_steel(), slab_dx, {20, 16, 8}, 300.0,
        [](const Vec3& x) {
            return x.x() > 4.0 * slab_dx && x.x() < 11.5 * slab_dx && x.y() < 9.0 * slab_dx;
        },
        boundary);
    const double dt = 1e-6;
    const std::array<double, 6> in = deposit_face_fluxes(body.grid, boundary, body.eos, dt, body.nodes);
    EXPECT_NEAR(in[4], 1e8 * 7.5 * 9.0 * slab_dx * slab_dx * dt, 1e-12 * in[4]);
    EXPECT_NEAR(std::accumulate(body.nodes.increment.begin(), body.nodes.increment.end(), 0.0), in[4],
                1e-12 * in[4]);
    for (const int f : {0, 1, 2, 3, 5})
        EXPECT_EQ(in[f], 0.0);
}

TEST(FaceFlux, a_body_clear_of_the_face_gets_nothing) {
    Boundary boundary;
    boundary[5] = flux_of(1e8);
    LatticeBody body = make_lattice_body(
        plain_steel(), slab_dx, {8, 8, 12}, 300.0, [](const Vec3& x) { return x.z() < 10.0 * slab_dx; },
        boundary);
    EXPECT_EQ(deposit_face_fluxes(body.grid, boundary, body.eos, 1e-6, body.nodes)[5], 0.0);
}

TEST(FaceFlux, convection_of_any_strength_never_leads_beyond_ambient) {
    for (const double h : {1e3, 1e8, 1e15}) {
        Boundary boundary;
        boundary[0] = boundary[3] = convection_of(h, 300.0);
        LatticeBody body = full_box({10, 8, 4}, 1200.0, boundary);
        body.options.blend = 0.4;
        for (int n = 0; n < 60; ++n) {
            step(body, 0.4 * slab_dx * slab_dx / diffusivity);
            for (const double e : list_particles(body.particles).specific_energy)
                ASSERT_GE(body.eos[0].temperature(e), 300.0 - 1e-6) << "h " << h << ", step " << n;
        }
    }
}

} // namespace
} // namespace meltscope
