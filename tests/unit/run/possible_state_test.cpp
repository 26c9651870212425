#include "meltscope/run/possible_state.hpp"

#include "block.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace meltscope {
namespace {

using test::steel_block;

constexpr double target_time = 1.0; // s, of a step's target: the largest step is taken

/// What stops a block one of whose particles is given this energy (J/kg) after three steps.
std::string stop_of_poisoned(std::int64_t particle, double energy) {
    Simulation s = steel_block();
    for (int n = 0; n < 3; ++n)
        advance(s, target_time);
    s.particles.specific_energy[s.particles.layout.place[particle]] = energy;
    try {
        for (int n = 0; n < 2; ++n) // the nodes hold what was gathered before: the step after sees it
            advance(s, target_time);
    } catch (const SolutionError& error) {
        EXPECT_LE(s.step, 5);
        return error.what();
    }
    return "it went on";
}

void expect_holds(const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
}

TEST(PossibleState, an_energy_that_is_not_a_number_stops_the_run_within_two_steps) {
    const std::int64_t last = steel_block().particles.count() - 1; // corners and whatever lies between
    for (std::int64_t particle = 0; particle <= last;
         particle = particle < last ? std::min(particle + 97, last) : last + 1)
        expect_holds(stop_of_poisoned(particle, std::numeric_limits<double>::quiet_NaN()),
                     {"after step ", "t = ", "particle ", " at (", ") m, of steel", "nan", "Likely cause: "});
}

TEST(PossibleState, an_infinite_energy_stops_the_run) {
    expect_holds(stop_of_poisoned(5, std::numeric_limits<double>::infinity()), {"particle ", "Likely cause"});
}

TEST(PossibleState, an_energy_below_that_of_absolute_zero_stops_the_run_and_names_the_step_size) {
    expect_holds(stop_of_poisoned(1234, -1e9), {"particle ", "time.cfl"});
}

TEST(PossibleState, heat_beyond_all_matter_stops_the_run_and_names_the_laser) {
    expect_holds(stop_of_poisoned(1234, 1e12), {"particle ", "power"});
}

TEST(PossibleState, the_poisoned_particle_is_named_with_its_place) {
    Simulation s = steel_block();
    s.particles.specific_energy[s.particles.layout.place[321]] = std::numeric_limits<double>::quiet_NaN();
    const Vec3& x = s.particles.position[321];
    try {
        require_possible(s, {false, 300.0, 300.0});
        FAIL() << "it went on";
    } catch (const SolutionError& error) {
        expect_holds(error.what(),
                     {"particle 321 at (" + fmt::format("{:.6g}, {:.6g}, {:.6g}", x[0], x[1], x[2])});
    }
}

TEST(PossibleState, hot_and_cold_matter_is_let_through) {
    const Simulation s = steel_block();
    EXPECT_NO_THROW(require_possible(s, {true, 1.0, 20000.0}));
}

} // namespace
} // namespace meltscope
