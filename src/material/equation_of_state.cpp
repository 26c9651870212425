#include "meltscope/material/equation_of_state.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace meltscope {
namespace {

constexpr double hottest_checked = 6000.0; // K
constexpr double inverse_tolerance = 1e-9; // K
constexpr int most_newton_steps = 12;

/// c(T) re-expanded about T = start: c = p[0] + p[1] t + p[2] t^2, t = T - start.
std::array<double, 3> about(const Polynomial& c, double start) {
    return {c(start), c.a[1] + 2.0 * c.a[2] * start, c.a[2]};
}

EquationOfState::Range single_phase_range(const Polynomial& heat_capacity, double start, double energy) {
    const auto c = about(heat_capacity, start);
    return {start, energy, {c[0], c[1] / 2.0, c[2] / 3.0, 0.0}, 0.0};
}

/// de/dT = c_s + f (c_l - c_s) + L/(T_l - T_s) with f = t/(T_l - T_s), integrated over t.
EquationOfState::Range mushy_range(const Material& m, double energy) {
    const double width = m.liquidus - m.solidus;
    const auto s = about(m.heat_capacity.solid, m.solidus);
    const auto l = about(m.heat_capacity.liquid, m.solidus);
    return {m.solidus,
            energy,
            {s[0] + m.latent_heat / width, (s[1] + (l[0] - s[0]) / width) / 2.0,
             (s[2] + (l[1] - s[1]) / width) / 3.0, (l[2] - s[2]) / width / 4.0},
            0.0};
}

double energy_at(const EquationOfState::Range& r, double t) {
    return t * (r.a[0] + t * (r.a[1] + t * (r.a[2] + t * r.a[3])));
}

double worst_inverse_error(const EquationOfState& eos) {
    double worst = 0.0;
    for (double t = 0.0; t <= hottest_checked; t += 1.0)
        worst = std::max(worst, std::abs(eos.temperature(eos.energy(t)) - t));
    return worst;
}

} // namespace

EquationOfState make_equation_of_state(const Material& m) {
    if (!(m.solidus < m.liquidus))
        throw std::invalid_argument(fmt::format("{}: the solidus ({} K) must lie below the liquidus ({} K)",
                                                m.name, m.solidus, m.liquidus));
    EquationOfState eos;
    eos.density = m.density;
    eos.solidus = m.solidus;
    eos.liquidus = m.liquidus;
    eos.inverse_freezing_range = 1.0 / (m.liquidus - m.solidus);
    eos.latent_heat = m.latent_heat;
    eos.solid_conductivity = m.conductivity.solid;
    eos.liquid_conductivity = m.conductivity.liquid;
    eos.powder_conductivity = m.conductivity.powder;
    eos.solid_heat_capacity = m.heat_capacity.solid;
    eos.liquid_heat_capacity = m.heat_capacity.liquid;
    for (double t = 0.0; t <= hottest_checked; t += 1.0) {
        const double c = t < m.solidus ? m.heat_capacity.solid(t) : m.heat_capacity.liquid(t);
        if (!(c > 0.0))
            throw std::invalid_argument(
                fmt::format("{}: the heat capacity is {} J/kg/K at {} K; it must be positive "
                            "from 0 to {} K",
                            m.name, c, t, hottest_checked));
    }

    eos.range[0] = single_phase_range(m.heat_capacity.solid, 0.0, 0.0);
    const double e_solidus = energy_at(eos.range[0], m.solidus);
    eos.range[1] = mushy_range(m, e_solidus);
    const double e_liquidus = e_solidus + energy_at(eos.range[1], m.liquidus - m.solidus);
    eos.range[2] = single_phase_range(m.heat_capacity.liquid, m.liquidus, e_liquidus);
    // The chord of each bounded range; the liquid has no end, so its chord ends where temperatures are
    // checked.
    eos.range[0].guess = m.solidus / e_solidus;
    eos.range[1].guess = (m.liquidus - m.solidus) / (e_liquidus - e_solidus);
    eos.range[2].guess =
        (hottest_checked - m.liquidus) / energy_at(eos.range[2], hottest_checked - m.liquidus);

    while (worst_inverse_error(eos) > inverse_tolerance) {
        if (++eos.newton_steps > most_newton_steps)
            throw std::invalid_argument(
                fmt::format("{}: T(e) cannot be inverted; its heat capacity varies too sharply", m.name));
    }
    return eos;
}

double max_diffusivity(const EquationOfState& eos, double coldest, double hottest) {
    double most = 0.0;
    const int samples = 16 + int((hottest - coldest) / 4.0);
    for (int i = 0; i <= samples; ++i) {
        const double t = coldest + (hottest - coldest) * i / samples;
        double kappa = eos.conductivity(t);
        if (eos.powder_conductivity && t < eos.liquidus)
            kappa = std::max(kappa, (*eos.powder_conductivity)(t));
        most = std::max(most, kappa / (eos.density * eos.heat_capacity(t)));
    }
    return most;
}

double max_powder_diffusivity(const EquationOfState& eos) {
    double most = 0.0;
    if (eos.powder_conductivity)
        for (double t = 0.0; t < eos.liquidus; t += 4.0)
            most = std::max(most, (*eos.powder_conductivity)(t) / (eos.density * eos.heat_capacity(t)));
    return most;
}

} // namespace meltscope
