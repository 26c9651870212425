#pragma once

namespace meltscope {

/// Multiply-adds that all threads together do at most, GFLOP/s: independent chains of them in registers, as
/// wide as the lane groups of the solver. Median of several repetitions.
double probe_fma_gflops();

/// Bandwidth of a = b + s c over arrays far larger than the caches, GB/s, counted as STREAM does (24 bytes an
/// element; J. D. McCalpin, STREAM: Sustainable Memory Bandwidth in High Performance Computers). Median of
/// several repetitions.
double probe_triad_gb_per_s();

} // namespace meltscope
