#pragma once

#include "bench_insitu.hpp"
#include "bench_phases.hpp"

#include "meltscope/scenario/scenario.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace meltscope {

/// Seconds of a step by phase, in the order of all_phases.
using PhaseSeconds = std::array<double, all_phases.size()>;

/// How fast one form of the step is on one scene.
struct SpeedFigures {
    std::string transfer; ///< affine or flip
    int threads = 0;
    double step_seconds = 0.0; ///< of a whole step
    double particle_steps_per_s = 0.0;
    PhaseSeconds phases{};
    double rest_seconds = 0.0; ///< that the phases leave of a whole step
};

/// Wall seconds of what comes before the first step.
struct SetupFigures {
    double packing_seconds = 0.0;   ///< bodies: powder packed, files read
    double filling_seconds = 0.0;   ///< particles set into the bodies
    double preparing_seconds = 0.0; ///< layout, node masses, free surface, light map, first P2G
    double surface_seconds = 0.0;   ///< of it: signed distance and surface weights
    double elements_seconds = 0.0;  ///< of it: what the surface's heat needs beside these, element by element
    std::int64_t nodes_in_band = 0; ///< that the signed distance is worked out for
    double peak_bytes = 0.0;        ///< beyond what the program held before
    double bytes_a_particle = 0.0;  ///< held from step to step
    double bytes_a_node = 0.0;      ///< held from step to step

    double node_updates_per_s() const { return double(nodes_in_band) / surface_seconds; }
};

/// All that is measured on one scene.
struct SceneFigures {
    std::string scene;
    std::int64_t particles = 0, nodes = 0;
    std::int64_t entries = 0; ///< of the lane layout: particles and padding
    SetupFigures setup;
    std::vector<SpeedFigures> speed; ///< the first is that of the scenario's transfer and all threads
    double fma_gflops = 0.0, triad_gb_per_s = 0.0;
    std::optional<InSituCost> in_situ;

    /// What the probes allow, particle-steps/s: a particle-step needs about 800 operations and 128 bytes.
    double limit() const { return std::min(fma_gflops * 1e9 / 800.0, triad_gb_per_s * 1e9 / 128.0); }
};

/// Sets the scene up and steps it, taking turns between the transfer forms and the numbers of threads: the
/// scenario's form alone unless `both_transfers`, and all threads and one unless there is but one. Throws
/// UsageError if the scenario needs more memory than there is.
SceneFigures measure_scene(const std::string& name, const Scenario& scenario, bool both_transfers,
                           bool in_situ);

} // namespace meltscope
