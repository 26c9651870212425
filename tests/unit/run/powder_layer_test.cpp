#include "block.hpp"

#include "meltscope/run/powder_layer.hpp"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

namespace meltscope {
namespace {

using Site = std::tuple<std::int64_t, std::int64_t, std::int64_t>;

Site site_of(const Simulation& s, const Vec3& x) {
    const Vec3 n = (x - s.grid.origin) / (s.grid.dx / s.particles.lattice);
    return {std::int64_t(n[0]), std::int64_t(n[1]), std::int64_t(n[2])};
}

PowderLayer homogenised(double thickness) {
    PowderLayer layer;
    layer.thickness = thickness;
    layer.homogenised = true;
    layer.packing = 0.5;
    return layer;
}

PowderLayer balls(double thickness) {
    PowderLayer layer;
    layer.thickness = thickness;
    layer.d10 = layer.d50 = layer.d90 = 25e-6;
    layer.packing = 0.3;
    return layer;
}

TEST(PowderLayer, homogenised_fills_the_layer_and_holds_its_share_of_the_mass) {
    Simulation s = test::steel_block(0.5); // up to 40 um of 80 um
    const std::int64_t before = s.particles.count();
    const double stored = total_energy(s.particles);
    const std::int64_t added = add_layer(s, homogenised(30e-6));
    EXPECT_EQ(added, s.particles.count() - before);
    EXPECT_EQ(added, 24 * 16 * 6);
    double mass = 0.0;
    const ParticleList list = list_particles(s.particles);
    for (std::int64_t q = before; q < list.size(); ++q) {
        mass += list.mass[q];
        EXPECT_EQ(list.powder[q], 1);
        EXPECT_EQ(list.id[q], q);
    }
    EXPECT_NEAR(mass, 0.5 * 8000.0 * 120e-6 * 80e-6 * 30e-6, 1e-6 * mass);
    EXPECT_NEAR(total_energy(s.particles), stored + s.ledger.added, 1e-12 * stored);
}

TEST(PowderLayer, fills_dips_from_above_and_leaves_pores_below_a_roof_empty) {
    Simulation s = test::steel_block(0.25); // floor of 20 um
    // A roof over half of the domain at 40 to 45 um, with nothing below it.
    ParticleList roof;
    for (std::int64_t j = 0; j < 16; ++j)
        for (std::int64_t i = 0; i < 12; ++i) {
            roof.position.push_back(5e-6 * Vec3(i + 0.5, j + 0.5, 8.5));
            roof.volume.push_back(125e-18);
            roof.mass.push_back(1e-12);
            roof.specific_energy.push_back(150e3);
            roof.id.push_back(s.particles.count() + roof.size() - 1);
            roof.material.push_back(0);
        }
    add_particles(s, roof);
    const std::int64_t before = s.particles.count();
    add_layer(s, homogenised(10e-6)); // up to 55 um
    std::set<Site> sites;
    for (const Vec3& x : s.particles.position)
        EXPECT_TRUE(sites.insert(site_of(s, x)).second) << "two particles at one site";
    EXPECT_FALSE(sites.contains({3, 3, 6})) << "below the roof";
    EXPECT_TRUE(sites.contains({20, 3, 6})) << "beside the roof";
    EXPECT_TRUE(sites.contains({3, 3, 10})) << "above the roof";
    EXPECT_EQ(s.particles.count() - before, 12 * 16 * 2 + 12 * 16 * 7);
}

TEST(PowderLayer, balls_settle_on_what_lies_below_without_sharing_sites) {
    Simulation s = test::steel_block(0.5);
    const std::int64_t before = s.particles.count();
    add_layer(s, balls(40e-6));
    ASSERT_GT(s.particles.count(), before);
    std::set<Site> sites;
    double lowest = 1.0;
    for (std::int64_t q = 0; q < s.particles.count(); ++q) {
        EXPECT_TRUE(sites.insert(site_of(s, s.particles.position[q])).second);
        if (q >= before) {
            lowest = std::min(lowest, s.particles.position[q][2]);
        }
    }
    EXPECT_GT(lowest, 40e-6);
    EXPECT_LT(lowest, 50e-6) << "some ball touches the plate";
    EXPECT_TRUE(s.particles.powder.empty()) << "resolved balls are bulk";
}

TEST(PowderLayer, the_same_layer_gives_the_same_particles) {
    Simulation a = test::steel_block(0.5), b = test::steel_block(0.5);
    add_layer(a, balls(40e-6));
    add_layer(b, balls(40e-6));
    ASSERT_EQ(a.particles.count(), b.particles.count());
    for (std::int64_t q = 0; q < a.particles.count(); ++q)
        EXPECT_EQ(a.particles.position[q], b.particles.position[q]);
    EXPECT_EQ(a.nodes.temperature, b.nodes.temperature);
}

TEST(PowderLayer, one_that_does_not_fit_is_refused_and_changes_nothing) {
    Simulation s = test::steel_block(0.5);
    const std::int64_t before = s.particles.count();
    EXPECT_THROW(add_layer(s, homogenised(50e-6)), GeometryError);
    PowderLayer dense = balls(40e-6);
    dense.packing = 0.73;
    EXPECT_THROW(add_layer(s, dense), GeometryError);
    PowderLayer unknown = homogenised(20e-6);
    unknown.material = 3;
    EXPECT_THROW(add_layer(s, unknown), std::invalid_argument);
    EXPECT_EQ(s.particles.count(), before);
}

TEST(PowderLayer, layers_that_can_never_fit_are_refused_before_the_run) {
    const Simulation s = test::steel_block(0.5); // up to 40 um of 80 um
    const auto layers = [](const PowderLayer& first, const PowderLayer& second) {
        return std::vector<ScheduledLayer>{{2e-3, second}, {1e-3, first}}; // in any order
    };
    EXPECT_NO_THROW(require_room_for_layers(s, layers(homogenised(20e-6), homogenised(20e-6)), 0));
    EXPECT_THROW(require_room_for_layers(s, layers(homogenised(20e-6), homogenised(25e-6)), 0),
                 GeometryError);
    EXPECT_THROW(require_room_for_layers(s, layers(homogenised(45e-6), homogenised(10e-6)), 0),
                 GeometryError);
    // Balls need not reach the layer's top, so a layer on them may still fit.
    EXPECT_NO_THROW(require_room_for_layers(s, layers(balls(30e-6), homogenised(20e-6)), 0));
    // The first one is there already.
    EXPECT_NO_THROW(require_room_for_layers(s, layers(homogenised(50e-6), homogenised(40e-6)), 1));
    PowderLayer without_material = homogenised(10e-6);
    without_material.material = 7;
    EXPECT_THROW(require_room_for_layers(s, layers(without_material, homogenised(10e-6)), 0),
                 std::invalid_argument);
}

TEST(PowderLayer, scheduled_layers_come_once_and_in_time) {
    meltscope::Run run;
    run.simulation = test::steel_block(0.25);
    const std::int64_t before = run.simulation.particles.count();
    const CommandSource source = scheduled_layers({{2e-3, homogenised(20e-6)}, {1e-3, homogenised(10e-6)}});
    EXPECT_EQ(source.next_time(run), 1e-3);
    source.apply(run);
    EXPECT_EQ(run.simulation.particles.count(), before);
    run.simulation.time = 1e-3;
    source.apply(run);
    source.apply(run);
    EXPECT_EQ(run.simulation.particles.count(), before + 24 * 16 * 2);
    EXPECT_EQ(source.next_time(run), 2e-3);
    run.simulation.time = 2e-3;
    source.apply(run);
    EXPECT_EQ(run.simulation.particles.count(), before + 24 * 16 * 6);
    EXPECT_EQ(source.next_time(run), never);
    source.apply(run);
    EXPECT_EQ(run.layers_laid, 2);
}

} // namespace
} // namespace meltscope
