#pragma once

#include "meltscope/run/simulation.hpp"

#include <array>

namespace meltscope {

/// The parts of a step, in their order.
enum class StepPhase { diffuse, laser, losses, update, g2p, favre };

inline constexpr std::array all_phases{StepPhase::diffuse, StepPhase::laser, StepPhase::losses,
                                       StepPhase::update,  StepPhase::g2p,   StepPhase::favre};

/// Name of a phase in tables and JSON.
const char* phase_name(StepPhase phase);

/// Does one phase as advance() does it, with the step size of the last step; all of them in their order are a
/// step but for the choice of its size, the ledger and the search for extremes. No quiescent part of the body
/// is left out.
void run_phase(Simulation& simulation, StepPhase phase);

} // namespace meltscope
