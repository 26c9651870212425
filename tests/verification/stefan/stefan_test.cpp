#include "reference/driver.hpp"
#include "reference/stefan.hpp"
#include "reference/table.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

constexpr int cells = 100;
constexpr double melting = 1000.0, solid_below = 100.0; // K

struct Result {
    double front_error = 0.0;        ///< largest of the front's place once it is beyond ten cells, relative
    double profile_error = 0.0;      ///< largest away from the front, by the temperature range
    double below = 0.0, above = 0.0; ///< K, particles beyond the start and the wall
    double nodes_below = 0.0, nodes_above = 0.0; ///< K, nodes
};

/// Place of the front in cells: the length that has melted, by the liquid fraction of all particles.
double front(const ThermalRun& run) {
    double volume = 0.0;
    for (std::int64_t q = 0; q < run.particles.count(); ++q)
        volume += run.particles.volume[run.particles.layout.place[q]] *
                  run.materials[0].liquid_fraction(run.own_temperature(q));
    return volume;
}

/// Melts a bar from its wall x = 0; kappa = rho = c = 1, dx = 1. `mushy`: half the freezing range in K.
Result melt(const Stefan& stefan, double mushy, const std::string& name, const Stepping& stepping = {}) {
    const double wall = melting + solid_below * stefan.liquid / stefan.solid, start = melting - solid_below;
    Material m = constant_material();
    m.solidus = melting - mushy;
    m.liquidus = melting + mushy;
    m.latent_heat = solid_below / stefan.solid;
    const Grid grid = make_grid(Vec3::Zero(), 1.0, {cells, 1, 1});
    const std::vector<EquationOfState> materials{make_equation_of_state(m)};
    ParticleList list = lattice_points(grid, 2, everywhere);
    set_state(
        materials, [=](const Vec3&) { return start; }, list);
    Boundary boundary;
    boundary[0] = {FaceCondition::Kind::fixed_temperature, wall, 0.0, 0.0};
    ThermalRun run(grid, materials, boundary, std::move(list), 2, stepping);

    const double lambda = stefan.root();
    const double last = 24.0; // cells; the far end then does not matter yet
    ResultTable fronts("stefan_" + name + "_front", "time,exact_cells,computed_cells,error_percent");
    Result result;
    for (double s = 2.0; s <= last; s += 2.0) {
        const double t = s * s / (4.0 * lambda * lambda);
        run.advance(t - run.time, 1.0);
        const double got = front(run);
        if (s >= 10.0)
            result.front_error = std::max(result.front_error, std::abs(got / s - 1.0));
        fronts.row({t, s, got, 100.0 * (got / s - 1.0)});
        result.below = std::max(result.below, start - run.coldest_particle());
        result.above = std::max(result.above, run.hottest_particle() - wall);
        for (int i = 0; i <= cells; ++i) {
            const double node = run.nodes.temperature[grid.index(i, 0, 0)];
            result.nodes_below = std::max(result.nodes_below, start - node);
            result.nodes_above = std::max(result.nodes_above, node - wall);
        }
    }
    ResultTable profile("stefan_" + name + "_profile", "x,exact,computed");
    for (int i = 0; i <= 2 * cells; ++i) {
        const double x = 0.5 * i;
        const double exact = stefan_temperature(x, run.time, 1.0, lambda, wall, melting, start);
        const double got = run.temperature(Vec3(x, 0.5, 0.5));
        profile.row({x, exact, got});
        if (x <= 60.0 && std::abs(x - last) > 2.0)
            result.profile_error = std::max(result.profile_error, std::abs(got - exact) / (wall - start));
    }
    return result;
}

void expect_front(const Stefan& stefan, const std::string& name) {
    ResultTable table("stefan_" + name,
                      "mushy_half_width_K,front_percent,profile_percent,particles_below_K,particles_above_K,"
                      "nodes_below_K,nodes_above_K");
    for (const double mushy : {1.0, 0.25}) {
        const Result r = melt(stefan, mushy, name + (mushy == 1.0 ? "_wide" : ""));
        table.row({mushy, 100.0 * r.front_error, 100.0 * r.profile_error, r.below, r.above, r.nodes_below,
                   r.nodes_above});
        EXPECT_LT(r.front_error, 0.01) << "freezing range " << 2.0 * mushy << " K";
        EXPECT_LT(r.profile_error, 0.01) << "freezing range " << 2.0 * mushy << " K";
        const double range = solid_below * (1.0 + stefan.liquid / stefan.solid);
        EXPECT_LT(std::max(r.nodes_below, r.nodes_above), 1e-4 * range);
        EXPECT_LT(std::max(r.below, r.above), 1e-4 * range);
    }
}

TEST(Stefan, front_within_1_percent_at_stefan_numbers_1_and_1) {
    expect_front({1.0, 1.0, 1.0}, "1_1");
}
TEST(Stefan, front_within_1_percent_at_stefan_numbers_2_and_1) {
    expect_front({2.0, 1.0, 1.0}, "2_1");
}

} // namespace
} // namespace meltscope::verification
