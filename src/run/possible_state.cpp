#include "meltscope/run/possible_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope {
namespace {

/// How far beyond the possible a temperature is, K; infinite for what is not a number.
double excess(double temperature) {
    if (!std::isfinite(temperature))
        return std::numeric_limits<double>::infinity();
    return std::max({0.0, -temperature, temperature - highest_possible_temperature});
}

/// The particle that is furthest from the possible, by its own energy or by that of the nodes around it.
struct Offender {
    std::int64_t index = 0;
    double own = 0.0, around = 0.0; ///< K
    double excess = -1.0;           ///< K
};

Offender find_offender(const Simulation& s) {
    const Field around = particle_temperatures(s.grid, s.particles, s.nodes);
    Offender worst;
    for (std::int64_t q = 0; q < s.particles.count(); ++q) { // in the order of ids: the first of equals
        const std::int64_t at = s.particles.layout.place[q];
        const double own = s.eos[s.particles.material[q]].temperature(s.particles.specific_energy[at]);
        const double here = std::max(excess(own), excess(around[at]));
        if (here > worst.excess)
            worst = {q, own, around[at], here};
    }
    return worst;
}

const char* likely_cause(const Offender& offender) {
    if (offender.own > highest_possible_temperature || offender.around > highest_possible_temperature)
        return "more power is absorbed than conduction carries away: look at the laser's power and "
               "spot_radius, "
               "and at physics.evaporation, which bounds the temperature";
    if (offender.own < 0.0 || offender.around < 0.0)
        return "the step is too long for the particles there: a smaller time.cfl";
    return "a value of the scenario or of the checkpoint that is not a number, or a step too long by far: "
           "a smaller time.cfl";
}

} // namespace

void require_possible(const Simulation& s, const ReachedTemperatures& reached) {
    if (reached.finite && reached.coldest >= 0.0 && reached.hottest <= highest_possible_temperature)
        return;
    const Offender offender = find_offender(s);
    const std::int64_t q = offender.index;
    const Vec3& x = s.particles.position[q];
    throw SolutionError(
        fmt::format("after step {}, t = {:.6g} s, particle {} at ({:.6g}, {:.6g}, {:.6g}) m, of {}, has an "
                    "impossible energy: "
                    "{:.6g} J/kg is {:.6g} K, and the nodes around it are at {:.6g} K. Likely cause: {}",
                    s.step, s.time, s.particles.id_of(q), x[0], x[1], x[2],
                    s.parameters.materials[s.particles.material[q]].name,
                    s.particles.specific_energy[s.particles.layout.place[q]], offender.own, offender.around,
                    likely_cause(offender)));
}

} // namespace meltscope
