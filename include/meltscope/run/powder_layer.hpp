#pragma once

#include "meltscope/build/powder.hpp"
#include "meltscope/run/run_loop.hpp"

#include <cstdint>
#include <vector>

namespace meltscope {

/// A layer of powder that is spread over all of the domain during a run.
struct PowderLayer {
    double thickness = 0.0;      ///< m, from the highest material to the layer's top
    std::int16_t material = 0;   ///< index into the run's materials
    double temperature = 298.15; ///< K
    double packing = 0.5;        ///< share of the layer's volume that is powder
    bool homogenised = false;    ///< no balls but a medium of that density, with the powder's conductivity
    double d10 = 0.0, d50 = 0.0, d90 = 0.0; ///< m, percentiles of the balls' diameters
    PercentileBasis basis = PercentileBasis::number;
    std::uint64_t seed = 1;

    bool operator==(const PowderLayer&) const = default;
};

/// Spreads a layer on whatever lies below: balls settle on it, homogenised powder fills what is open from
/// above. Pores that lie under something stay empty. The new particles sit on the lattice of the others and
/// take the ids that follow. The same state and layer give the same particles, bit for bit. Returns how many
/// were added. Throws GeometryError for a layer that does not fit under the domain's top or cannot be packed,
/// std::invalid_argument for a material that is not there or has no powder conductivity, and for a run whose
/// particles sit on no lattice.
std::int64_t add_layer(Simulation& simulation, const PowderLayer& layer);

/// A layer and when it is laid.
struct ScheduledLayer {
    double time = 0.0; ///< s
    PowderLayer layer;

    bool operator==(const ScheduledLayer&) const = default;
};

/// Refuses, before a run, layers that are sure not to fit below the domain's top; `laid` of them are there
/// already. Balls are taken to add no height. Throws as add_layer.
void require_room_for_layers(const Simulation& simulation, std::vector<ScheduledLayer> layers,
                             std::int64_t laid);

/// Lays the layers of a scenario, in the order of their times. Run::layers_laid counts them, so that a run
/// taken up from a checkpoint does not lay one twice.
CommandSource scheduled_layers(std::vector<ScheduledLayer> layers);

} // namespace meltscope
