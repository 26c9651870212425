#pragma once

namespace meltscope {

/// Memory that this process may use at most, bytes: the machine's, or its control group's limit if that is
/// lower.
double physical_memory();

/// Memory that this process holds at most so far, bytes.
double peak_memory();

/// Starts peak_memory() anew where the kernel can do that, and says what the process holds now, bytes.
double forget_peak_memory();

/// Starts the program once more with sleeping waits set for OpenMP, unless the user has set how threads wait.
/// Those that spin at a barrier take the cores from the picture thread and from other programs, which then
/// keep the step waiting: on a busy machine a run was six times slower. The OpenMP library reads its settings
/// only when it is loaded.
void let_threads_sleep(char** arguments);

} // namespace meltscope
