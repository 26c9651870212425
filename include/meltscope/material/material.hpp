#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace meltscope {

/// a0 + a1 T + a2 T^2, T in kelvin.
struct Polynomial {
    std::array<double, 3> a{0.0, 0.0, 0.0};

    double operator()(double temperature) const { return a[0] + temperature * (a[1] + temperature * a[2]); }
};

/// A property that has one polynomial for each state of the matter.
struct PhaseProperty {
    Polynomial solid;
    Polynomial liquid;
    std::optional<Polynomial> powder; ///< homogenised powder, until it has melted once
};

/// What a material file says. Density is a constant; the latent heat is spread linearly over [solidus,
/// liquidus].
struct Material {
    std::string name;
    double density = 0.0;                ///< kg/m^3
    double solidus = 0.0;                ///< K
    double liquidus = 0.0;               ///< K
    double latent_heat = 0.0;            ///< J/kg, of fusion
    PhaseProperty conductivity;          ///< W/m/K
    PhaseProperty heat_capacity;         ///< J/kg/K; that of the powder is not used: see scenario_notes
    std::optional<double> emissivity;    ///< 1
    std::optional<double> boiling_point; ///< K
    std::optional<double> latent_heat_of_vaporization; ///< J/kg
    std::optional<double> molar_mass;                  ///< kg/mol
    std::string source;                                ///< where the figures come from
};

} // namespace meltscope
