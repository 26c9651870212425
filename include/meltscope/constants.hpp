#pragma once

/// Physical constants, SI (CODATA 2018; the first three are exact by definition of the SI).
namespace meltscope::constants {

inline constexpr double stefan_boltzmann = 5.670374419e-8; // W/m^2/K^4
inline constexpr double gas_constant = 8.314462618;        // J/mol/K
inline constexpr double standard_atmosphere = 101325.0;    // Pa
inline constexpr double pi = 3.14159265358979323846;

} // namespace meltscope::constants
