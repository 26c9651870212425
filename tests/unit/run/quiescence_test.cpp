#include "block.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cstring>
#include <functional>

#include <fmt/format.h>

namespace meltscope {
namespace {

using test::block_grid;
using test::block_parameters;
using test::block_particles;

constexpr double start_temperature = 300.0;
/// What every run keeps to; sums of all particles' energies, lane by lane or one by one, round at a tenth of
/// it.
constexpr double energy_closes = 1e-12;

/// A plate of 640 x 240 x 220 um with 40 um of nothing above it, and a laser that runs along it.
RunParameters plate_parameters(double tolerance) {
    RunParameters parameters = block_parameters();
    parameters.physics.quiescent_tolerance = tolerance;
    parameters.physics.ambient = start_temperature;
    Laser laser;
    laser.power = 30.0;
    laser.absorptivity = 0.4;
    laser.spot_radius = 25e-6;
    laser.path.start = {60e-6, 60e-6, 220e-6};
    PathSegment line;
    line.end = {560e-6, 60e-6, 220e-6};
    line.speed = 1.0;
    laser.path.segments = {line};
    parameters.lasers = {laser};
    return parameters;
}

Grid plate_grid() {
    return block_grid({64, 24, 26});
}

Simulation plate(RunParameters parameters) {
    const Grid grid = plate_grid();
    return make_simulation(std::move(parameters), grid, block_particles(grid, 220e-6, start_temperature), 2);
}

Simulation plate(double tolerance = 1e-6) {
    return plate(plate_parameters(tolerance));
}

void run(Simulation& s, int steps) {
    for (int n = 0; n < steps; ++n)
        advance(s, 1.0);
    balance(s);
}

std::int64_t asleep(const Simulation& s) {
    return std::int64_t(sleeping_bricks(s.quiescence.bricks).size());
}

bool same_bits(const Field& a, const Field& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

void expect_same_state(const Simulation& a, const Simulation& b) {
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(list_particles(a.particles).specific_energy, list_particles(b.particles).specific_energy);
    EXPECT_TRUE(same_bits(a.nodes.temperature, b.nodes.temperature));
    EXPECT_TRUE(same_bits(a.nodes.mass_energy, b.nodes.mass_energy));
    EXPECT_EQ(a.ledger.stored, b.ledger.stored);
    EXPECT_EQ(a.ledger.conducted_out, b.ledger.conducted_out);
    EXPECT_EQ(a.ledger.lost(), b.ledger.lost());
    EXPECT_EQ(a.quiescence.bricks.awake, b.quiescence.bricks.awake);
}

double largest_gap(const Field& a, const Field& b) {
    double most = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, std::abs(a[i] - b[i]));
    return most;
}

/// Ways to set a run up, by what is special in them.
std::vector<std::pair<const char*, std::function<void(RunParameters&)>>> variants() {
    const auto hold_faces = [](RunParameters& p) {
        for (const int f : {0, 1, 2, 3, 4})
            p.boundary[f] = {FaceCondition::Kind::fixed_temperature, start_temperature, 0.0, 0.0};
    };
    return {{"plain", [](RunParameters&) {}},
            {"flip", [](RunParameters& p) { p.physics.affine_transfer = false; }},
            {"energy form", [](RunParameters& p) { p.physics.diffuse_energy = true; }},
            {"band", [](RunParameters& p) { p.physics.deposit_at_surface = false; }},
            {"fixed faces", hold_faces},
            {"warm wall",
             [=](RunParameters& p) {
                 hold_faces(p);
                 p.boundary[0].temperature = start_temperature + 50.0;
             }},
            {"losses", [](RunParameters& p) { p.physics.convection = 1e5; }},
            {"losses of a warm plate",
             [](RunParameters& p) {
                 p.physics.convection = 1e5;
                 p.physics.ambient = start_temperature - 20.0;
             }},
            {"flux through a face",
             [](RunParameters& p) {
                 p.boundary[4] = {FaceCondition::Kind::fixed_flux, 0.0, 0.0, 1e8};
             }},
            {"cool air at a face",
             [](RunParameters& p) {
                 p.boundary[1] = {FaceCondition::Kind::convection, 280.0, 1e5, 0.0};
             }},
            {"light into the depth", [](RunParameters& p) {
                 p.lasers[0].profile = BeamProfile::volumetric;
                 p.lasers[0].volume_depth = 30e-6;
             }}};
}

TEST(Quiescence, a_cold_plate_sleeps_until_the_laser_comes) {
    Simulation s = plate();
    // Bins 0 .. 64, 0 .. 24 and 0 .. 22 hold particles.
    EXPECT_EQ(asleep(s), 9 * 7 * 6);
    EXPECT_TRUE(s.particles.awake.runs.empty());
    EXPECT_TRUE(s.nodes.spans.empty());
    EXPECT_NEAR(s.coldest_temperature, start_temperature, 1.0);
    run(s, 1);
    EXPECT_FALSE(s.particles.awake.runs.empty());
    EXPECT_GT(asleep(s), 0);
    EXPECT_GT(s.peak_temperature, start_temperature + 10.0);
}

TEST(Quiescence, nothing_sleeps_without_a_tolerance) {
    Simulation s = plate(0.0);
    EXPECT_TRUE(s.quiescence.bricks.awake.empty());
    EXPECT_EQ(s.particles.awake.runs.size(),
              std::size_t(std::count_if(s.particles.layout.blocks.begin(), s.particles.layout.blocks.end(),
                                        [](const LaneBlock& b) { return b.first_group < b.last_group; })));
}

TEST(Quiescence, whoever_was_woken_before_anything_happened_might_as_well_not_have_slept) {
    int compared = 0;
    for (const auto& [name, change] : variants()) {
        SCOPED_TRACE(name);
        RunParameters parameters = plate_parameters(0.0);
        change(parameters);
        Simulation never = plate(parameters);
        parameters.physics.quiescent_tolerance = 1e-6;
        Simulation woken = plate(parameters);
        ASSERT_GT(asleep(woken), 0);
        if (!woken.particles.awake.runs.empty())
            continue; // nodes between those awake and those asleep would sum in another order
        ++compared;
        woken.parameters.physics.quiescent_tolerance = 0.0;
        run(never, 5);
        run(woken, 5);
        expect_same_state(never, woken);
    }
    EXPECT_GE(compared, 6);
}

TEST(Quiescence, sleep_changes_temperatures_by_about_the_tolerance) {
    for (const auto& [name, change] : variants())
        for (const double tolerance : {1e-6, 1e-2}) {
            SCOPED_TRACE(fmt::format("{}, {} K", name, tolerance));
            RunParameters parameters = plate_parameters(0.0);
            change(parameters);
            Simulation off = plate(parameters);
            parameters.physics.quiescent_tolerance = tolerance;
            Simulation s = plate(parameters);
            run(off, 6);
            run(s, 6);
            ASSERT_EQ(s.time, off.time);
            EXPECT_GT(asleep(s), 0);
            EXPECT_GT(s.peak_temperature, start_temperature + 100.0);
            EXPECT_LT(largest_gap(s.nodes.temperature, off.nodes.temperature), 10.0 * tolerance);
        }
}

TEST(Quiescence, energy_is_conserved_while_most_sleep) {
    for (const auto& [name, change] : variants()) {
        SCOPED_TRACE(name);
        RunParameters parameters = plate_parameters(1e-3);
        change(parameters);
        Simulation s = plate(parameters);
        std::int64_t before = asleep(s), woken_in_steps = 0;
        for (int n = 0; n < 12; ++n) {
            run(s, 1);
            woken_in_steps += asleep(s) < before;
            before = asleep(s);
        }
        EXPECT_GT(asleep(s), 0);
        EXPECT_GT(woken_in_steps, 1) << "the front moved more than once";
        EXPECT_GT(s.ledger.absorbed, 0.0);
        EXPECT_LT(std::abs(s.ledger.relative_residual()), energy_closes);
    }
}

TEST(Quiescence, heat_that_spreads_wakes_all_in_the_end) {
    RunParameters parameters = plate_parameters(1e-6);
    parameters.lasers.clear();
    const Grid grid = plate_grid();
    ParticleList list = block_particles(grid, 220e-6, start_temperature);
    for (std::int64_t q = 0; q < list.size(); ++q)
        if ((list.position[q] - Vec3(50e-6, 50e-6, 50e-6)).norm() < 20e-6)
            list.specific_energy[q] *= 2.0;
    Simulation s = make_simulation(parameters, grid, list, 2);
    EXPECT_GT(asleep(s), 30);
    std::int64_t before = asleep(s);
    while (before > 0) {
        ASSERT_LT(s.step, 500);
        advance(s, 1.0);
        ASSERT_LE(asleep(s), before);
        before = asleep(s);
    }
    balance(s);
    EXPECT_TRUE(s.quiescence.bricks.awake.empty());
    EXPECT_LT(std::abs(s.ledger.relative_residual()), energy_closes);
}

TEST(Quiescence, the_number_of_threads_changes_nothing) {
    const int before = omp_get_max_threads();
    std::vector<Simulation> runs;
    for (const int threads : {1, 2, 4}) {
        omp_set_num_threads(threads);
        RunParameters parameters = plate_parameters(1e-6);
        parameters.physics.convection = 1e5;
        runs.push_back(plate(parameters));
        run(runs.back(), 8);
    }
    omp_set_num_threads(before);
    EXPECT_GT(asleep(runs[0]), 0);
    expect_same_state(runs[0], runs[1]);
    expect_same_state(runs[0], runs[2]);
}

Simulation resumed(const Simulation& s) {
    return resume_simulation(s.parameters, s.grid, list_particles(s.particles), s.particles.lattice, s.time,
                             s.step, s.dt, s.ledger, s.nodes.mass_energy, s.least_temperature,
                             s.quiescence.bricks.awake);
}

TEST(Quiescence, a_resumed_run_goes_on_bit_for_bit) {
    for (const auto& [name, change] : variants()) {
        SCOPED_TRACE(name);
        RunParameters parameters = plate_parameters(1e-6);
        change(parameters);
        Simulation s = plate(parameters);
        run(s, 3);
        ASSERT_GT(asleep(s), 0);
        Simulation again = resumed(s);
        expect_same_state(s, again);
        run(s, 4);
        run(again, 4);
        expect_same_state(s, again);
    }
}

TEST(Quiescence, a_new_geometry_leaves_the_state_alone) {
    Simulation s = plate();
    run(s, 8);
    const Simulation before = s;
    update_geometry(s);
    expect_same_state(before, s);
    Simulation again = before;
    run(s, 5);
    run(again, 5);
    expect_same_state(s, again);
}

TEST(Quiescence, a_face_that_is_set_to_another_temperature_wakes_what_is_near) {
    Simulation s = plate(), off = plate(0.0);
    for (Simulation* each : {&s, &off}) {
        run(*each, 3);
        each->parameters.boundary[1] = {FaceCondition::Kind::fixed_temperature, 500.0, 0.0, 0.0};
        update_boundary(*each);
        run(*each, 5);
    }
    EXPECT_GT(asleep(s), 0);
    EXPECT_LT(s.ledger.conducted_out, 0.0);
    EXPECT_LT(std::abs(s.ledger.relative_residual()), energy_closes);
    EXPECT_NEAR(s.ledger.conducted_out, off.ledger.conducted_out, 1e-6 * std::abs(off.ledger.conducted_out));
    EXPECT_LT(largest_gap(s.nodes.temperature, off.nodes.temperature), 1e-4);
}

TEST(Quiescence, losses_that_are_switched_on_wake_the_surface) {
    Simulation s = plate(), off = plate(0.0);
    for (Simulation* each : {&s, &off}) {
        run(*each, 3);
        each->parameters.physics.convection = 1e5;
        each->parameters.physics.ambient = start_temperature - 100.0;
        update_losses(*each);
        run(*each, 5);
    }
    EXPECT_GT(asleep(s), 0);
    EXPECT_GT(s.ledger.convected, 0.0);
    EXPECT_LT(std::abs(s.ledger.relative_residual()), energy_closes);
    EXPECT_NEAR(s.ledger.convected, off.ledger.convected, 1e-9 * off.ledger.convected);
    Simulation again = resumed(s);
    run(s, 3);
    run(again, 3);
    expect_same_state(s, again);
}

TEST(Quiescence, particles_that_are_added_wake_what_they_touch) {
    const auto more = [](const Simulation& s) {
        ParticleList all = block_particles(s.grid, 240e-6, 350.0), added;
        for (std::int64_t q = 0; q < all.size(); ++q)
            if (all.position[q][2] > 220e-6 && all.position[q][0] < 200e-6) {
                added.position.push_back(all.position[q]);
                added.mass.push_back(all.mass[q]);
                added.volume.push_back(all.volume[q]);
                added.specific_energy.push_back(all.specific_energy[q]);
                added.material.push_back(0);
                added.id.push_back(s.particles.id_of(s.particles.count() - 1) + added.size());
            }
        return added;
    };
    Simulation s = plate(), off = plate(0.0);
    for (Simulation* each : {&s, &off}) {
        run(*each, 6);
        add_particles(*each, more(*each));
        balance(*each);
        EXPECT_LT(std::abs(each->ledger.relative_residual()), energy_closes);
        run(*each, 6);
    }
    EXPECT_GT(asleep(s), 0);
    EXPECT_LT(std::abs(s.ledger.relative_residual()), energy_closes);
    EXPECT_LT(largest_gap(s.nodes.temperature, off.nodes.temperature), 1e-4);
    Simulation again = resumed(s);
    run(s, 3);
    run(again, 3);
    expect_same_state(s, again);
}

TEST(Quiescence, masses_are_reported_of_those_asleep_too) {
    Simulation s = plate(), off = plate(0.0);
    run(s, 4);
    ASSERT_GT(asleep(s), 0);
    EXPECT_TRUE(same_bits(node_masses(s), off.nodes.mass));
}

} // namespace
} // namespace meltscope
