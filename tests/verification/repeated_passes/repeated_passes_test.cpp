#include "reference/table.hpp"
#include "reference/track.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

constexpr int passes = 10;

struct AfterPass {
    double coldest = 0.0; ///< K, above the start
    double hottest = 0.0; ///< K, above the start
    double spread = 0.0;  ///< by the peak rise of one pass
};

/// Ten passes over the same 5 sigma, Peclet number 7, four cells a sigma.
std::vector<AfterPass> run_passes(bool affine, bool at_surface, const std::string& name) {
    TrackCase c;
    c.length = 11.0;
    c.at_surface = at_surface;
    c.stepping.affine = affine;
    c.stepping.blend = affine ? -1.0 : 0.0;
    Track track(c);
    ResultTable table("repeated_passes_" + name,
                      "pass,coldest_rise_K,hottest_rise_K,spread_percent,energy_residual");
    std::vector<AfterPass> history;
    for (int pass = 1; pass <= passes; ++pass) {
        track.pass(5.0 / c.peclet);
        AfterPass now;
        now.coldest = track.run.coldest_particle() - plate_temperature;
        now.hottest = track.run.hottest_particle() - plate_temperature;
        now.spread = track.run.spread() / c.peak_rise;
        const double residual =
            std::abs(total_energy(track.run.particles) - track.run.start_energy - track.absorbed) /
            track.absorbed;
        EXPECT_LT(residual, 1e-11);
        table.row({double(pass), now.coldest, now.hottest, 100.0 * now.spread, residual});
        history.push_back(now);
    }
    return history;
}

TEST(RepeatedPasses, leave_no_particle_colder_than_it_started) {
    for (const AfterPass& now : run_passes(true, true, "affine"))
        EXPECT_GT(now.coldest, -1e-6) << "K";
}

TEST(RepeatedPasses, the_spread_of_the_particles_about_the_nodes_does_not_grow) {
    const std::vector<AfterPass> history = run_passes(true, true, "affine_spread");
    EXPECT_LT(history.back().spread, 0.10);
    EXPECT_LT(history.back().spread, 1.1 * history[1].spread);
}

TEST(RepeatedPasses, values_alone_and_heat_in_the_band_let_it_grow) {
    const std::vector<AfterPass> history = run_passes(false, false, "flip");
    EXPECT_GT(history.back().spread, 2.0 * history[0].spread);
}

} // namespace
} // namespace meltscope::verification
