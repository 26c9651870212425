#pragma once

#include <stdexcept>
#include <string_view>

namespace meltscope {

/// What a number measures: its name for messages and its SI unit as UDUNITS-2 spells it.
struct Quantity {
    const char* name;
    const char* unit;
};

/// The quantities that scenarios and commands use.
namespace quantity {
inline constexpr Quantity number{"number", "1"};
inline constexpr Quantity length{"length", "m"};
inline constexpr Quantity time{"time", "s"};
inline constexpr Quantity temperature{"temperature", "K"};
inline constexpr Quantity temperature_difference{"temperature difference", "K"};
inline constexpr Quantity power{"power", "W"};
inline constexpr Quantity speed{"speed", "m/s"};
inline constexpr Quantity angle{"angle", "rad"};
inline constexpr Quantity density{"density", "kg/m^3"};
inline constexpr Quantity specific_energy{"specific energy", "J/kg"};
inline constexpr Quantity molar_mass{"molar mass", "kg/mol"};
inline constexpr Quantity heat_flux{"heat flux", "W/m^2"};
inline constexpr Quantity heat_transfer_coefficient{"heat transfer coefficient", "W/m^2/K"};
} // namespace quantity

/// Text that is not the quantity asked for; what() says what is wrong and what would be right.
struct UnitError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The SI value of text such as "85 um" or "25 degC", by UDUNITS-2. Throws UnitError if the text is no finite
/// number with a unit, if the unit is unknown, if it does not measure `quantity` or if UDUNITS-2 has no
/// database of units. A number alone is taken only where the quantity has no unit. One thread at a time
/// converts, others wait.
double to_si(std::string_view text, const Quantity& quantity);

} // namespace meltscope
