#pragma once

namespace meltscope {

/// Memory that this process may use at most, bytes: the machine's, or its control group's limit if that is
/// lower.
double physical_memory();

/// Memory that this process holds at most so far, bytes.
double peak_memory();

/// Starts peak_memory() anew where the kernel can do that, and says what the process holds now, bytes.
double forget_peak_memory();

/// Has the C library keep arrays of up to 32 MB that are freed, up to 1 GB of them, unless the user has set
/// what it does. Those that a snapshot of two million particles needs for a moment came from the kernel page
/// by page each time, which took half of it. Elsewhere than with glibc nothing happens.
void keep_freed_memory();

/// Starts the program once more with OpenMP's threads set to sleep at barriers after some 100 us, unless the
/// user has set how they wait. A step has some thirty of them, and to wake a thread takes 50 us; threads that
/// spin for long take the cores from the picture thread and from other programs, which then keep the step
/// waiting: on a busy machine a run was six times slower. The OpenMP library reads its settings only when it
/// is loaded.
void let_threads_sleep(char** arguments);

} // namespace meltscope
