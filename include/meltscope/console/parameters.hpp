#pragma once

#include "meltscope/console/arguments.hpp"
#include "meltscope/console/console_state.hpp"

#include <functional>
#include <string>
#include <vector>

namespace meltscope {

/// Something of a run that get, set and list know.
struct Parameter {
    std::string name;
    std::string values; ///< what it can be, for help: "W, 0 or more"
    std::string help;
    std::vector<std::string> words; ///< that may stand as value, for completion
    std::function<std::string(const ConsoleState&, const Run&)> get;
    /// Reads a value into the parameters of the run; returns it as the journal keeps it. Empty: can only be
    /// read.
    std::function<std::string(ConsoleState&, Run&, Arguments&)> set;
    /// Makes anew what the simulation has derived from it. Empty: nothing.
    std::function<void(Simulation&)> renew = {};
};

/// The parameters of a run with these lasers. With one laser they are laser.power and so on, with several
/// laser.NAME.power.
std::vector<Parameter> parameters_of(const std::vector<Laser>& lasers);

/// The one that `name` means: whole, or an unambiguous beginning. laser.NAME.power is understood with one
/// laser, too. Throws CommandError.
Parameter find_parameter(const std::vector<Laser>& lasers, const std::string& name);

} // namespace meltscope
