#pragma once

#include "meltscope/run/simulation.hpp"

/// Which particles take part in the step; see docs/method.md, "Where nothing happens".
namespace meltscope {

/// At the start of a run, nodes' temperatures known: lets sleep what is quiet.
void fall_asleep(Simulation& simulation);

/// After nodes and surface were made anew for all particles and the nodes have the mass-energies and
/// temperatures of all: goes on with those that `awake` (one a brick; empty: all are) says.
void go_on_asleep(Simulation& simulation, std::vector<char> awake);

/// Before a step of `dt`: wakes what the heat of the last step has reached and what the sources of this one
/// will.
void wake_for_step(Simulation& simulation, double dt);

/// Before particles are added at the points (m): wakes what will share nodes with them, and one brick beyond.
/// Returns what is to be awake with the new ones, for go_on_asleep.
std::vector<char> wake_around(Simulation& simulation, const std::vector<Vec3>& points);

/// After losses were switched on or who is awake has changed.
void find_elements_awake(Simulation& simulation);

} // namespace meltscope
