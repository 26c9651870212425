#pragma once

#include "meltscope/lanes.hpp"
#include "meltscope/material/material.hpp"

#include <array>
#include <optional>

namespace meltscope {

/// Specific internal energy, temperature, conductivity and heat capacity of one material.
///
/// e(T) = integral of c dT from 0 K, plus the latent heat spread over [solidus, liquidus] with a liquid
/// fraction linear in T; in the mushy range c and kappa are mixed by that fraction. e(T) is therefore one
/// polynomial of degree four or less in each of three ranges, and T(e) its Newton inverse without branches.
/// Works on a double or on Lanes.
struct EquationOfState {
    /// One range: e = e_start + t (a1 + t (a2 + t (a3 + t a4))), t = T - T_start.
    struct Range {
        double temperature = 0.0; ///< K, where the range starts
        double energy = 0.0;      ///< J/kg, there
        std::array<double, 4> a{};
        double guess = 0.0; ///< K kg/J, first guess of t per unit of energy above the start
    };

    double density = 0.0;                                 ///< kg/m^3
    double solidus = 0.0, liquidus = 0.0;                 ///< K
    double inverse_freezing_range = 0.0;                  ///< 1/K
    double latent_heat = 0.0;                             ///< J/kg
    std::array<Range, 3> range;                           ///< solid, mushy, liquid
    int newton_steps = 0;                                 ///< enough for 1e-9 K over 0 .. 6000 K
    Polynomial solid_conductivity, liquid_conductivity;   ///< W/m/K
    std::optional<Polynomial> powder_conductivity;        ///< W/m/K, of homogenised powder
    Polynomial solid_heat_capacity, liquid_heat_capacity; ///< J/kg/K

    /// Share of liquid, 0 to 1. T in K.
    template <class Number>
    [[gnu::always_inline]] Number liquid_fraction(const Number& temperature) const {
        using std::max, std::min, std::experimental::max, std::experimental::min;
        return min(max((temperature - solidus) * inverse_freezing_range, Number(0.0)), Number(1.0));
    }

    /// Conductivity in W/m/K at T in K.
    template <class Number>
    [[gnu::always_inline]] Number conductivity(const Number& temperature) const {
        return mixed(solid_conductivity, liquid_conductivity, temperature, liquid_fraction(temperature));
    }

    /// Tangent de/dT in J/kg/K at T in K, latent heat included.
    template <class Number>
    [[gnu::always_inline]] Number heat_capacity(const Number& temperature) const {
        const Number c =
            mixed(solid_heat_capacity, liquid_heat_capacity, temperature, liquid_fraction(temperature));
        const Number latent = c + latent_heat * inverse_freezing_range;
        return select(temperature >= solidus, select(temperature < liquidus, latent, c), c);
    }

    /// Specific internal energy in J/kg at T in K.
    template <class Number>
    [[gnu::always_inline]] Number energy(const Number& temperature) const {
        const Number in_solid = energy_in(range[0], temperature);
        const Number in_mush = energy_in(range[1], temperature);
        const Number in_liquid = energy_in(range[2], temperature);
        return select(temperature < solidus, in_solid, select(temperature < liquidus, in_mush, in_liquid));
    }

    /// Temperature in K at e in J/kg; the inverse of energy().
    template <class Number>
    [[gnu::always_inline]] Number temperature(const Number& e) const {
        const auto in_solid = e < range[1].energy;
        const auto in_mush = e < range[2].energy;
        const auto pick = [&](double solid, double mush, double liquid) {
            return select(in_solid, Number(solid), select(in_mush, Number(mush), Number(liquid)));
        };
        const Number target = e - pick(range[0].energy, range[1].energy, range[2].energy);
        Number t = target * pick(range[0].guess, range[1].guess, range[2].guess);
        const Number start = pick(range[0].temperature, range[1].temperature, range[2].temperature);
        if (newton_steps == 0)
            return start + t;
        const Number a1 = pick(range[0].a[0], range[1].a[0], range[2].a[0]);
        const Number a2 = pick(range[0].a[1], range[1].a[1], range[2].a[1]);
        const Number a3 = pick(range[0].a[2], range[1].a[2], range[2].a[2]);
        const Number a4 = pick(range[0].a[3], range[1].a[3], range[2].a[3]);
        for (int i = 0; i < newton_steps; ++i) {
            const Number value = t * (a1 + t * (a2 + t * (a3 + t * a4)));
            const Number slope = a1 + t * (2.0 * a2 + t * (3.0 * a3 + t * (4.0 * a4)));
            t = t + (target - value) / slope;
        }
        return start + t;
    }

  private:
    template <class Number>
    [[gnu::always_inline]] static Number mixed(const Polynomial& solid, const Polynomial& liquid,
                                               const Number& temperature, const Number& liquid_share) {
        const Number s = solid.a[0] + temperature * (solid.a[1] + temperature * solid.a[2]);
        const Number l = liquid.a[0] + temperature * (liquid.a[1] + temperature * liquid.a[2]);
        return s + liquid_share * (l - s);
    }

    template <class Number>
    [[gnu::always_inline]] static Number energy_in(const Range& r, const Number& temperature) {
        const Number t = temperature - r.temperature;
        return r.energy + t * (r.a[0] + t * (r.a[1] + t * (r.a[2] + t * r.a[3])));
    }
};

/// Works out the energy polynomials and the Newton steps of `material` (bulk: solid and liquid).
/// Throws std::invalid_argument if solidus >= liquidus or a heat capacity is not positive over 0 .. 6000 K.
EquationOfState make_equation_of_state(const Material& material);

/// Largest kappa/(rho c) in m^2/s over [coldest, hottest] in K, outside and inside the mushy range, of the
/// bulk and, if the material has one, the powder's kappa with the bulk's rho.
double max_diffusivity(const EquationOfState& eos, double coldest, double hottest);

/// Largest kappa/(rho c) in m^2/s of powder below the liquidus, with the powder's kappa and the bulk's rho;
/// zero if the material has none.
double max_powder_diffusivity(const EquationOfState& eos);

} // namespace meltscope
