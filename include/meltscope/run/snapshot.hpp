#pragma once

#include "meltscope/beam/scan_path.hpp"
#include "meltscope/vec3.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace meltscope {

/// A field of one value a node, x fastest. Shared, because most fields outlive a snapshot unchanged.
using SharedField = std::shared_ptr<const std::vector<double>>;

/// The nodes that lie in the domain (no ghosts): node (i,j,k) is at origin + spacing (i,j,k).
struct NodeLattice {
    Vec3 origin = Vec3::Zero();          ///< m
    double spacing = 0.0;                ///< m
    std::array<std::int64_t, 3> count{}; ///< nodes along x, y, z
};

/// A region hotter than an isotherm, in the frame of a scan direction; all zero: there is none.
struct PoolFigures {
    double isotherm = 0.0; ///< K
    double length = 0.0;   ///< m, along the scan direction
    double width = 0.0;    ///< m, across it
    double depth = 0.0;    ///< m, from its highest point down
    double volume = 0.0;   ///< m^3
};

/// One of the pools that the material holds, told apart from the others.
struct SeparatePool {
    PoolFigures figures;         ///< in the frame of the first of its beams, or of the nearest
    Vec3 center = Vec3::Zero();  ///< m, of its volume
    double peak = 0.0;           ///< K
    std::vector<int> beams = {}; ///< whose pool it is, indices into Snapshot::beams
};

/// A laser as it stands at the snapshot's time.
struct BeamSnapshot {
    std::string name;
    Vec3 position = Vec3::Zero();       ///< m, the beam's axis where the path puts it
    Vec3 beam_direction{0, 0, -1};      ///< unit
    Vec3 scan_direction = Vec3::Zero(); ///< unit, zero while the beam dwells
    double power = 0.0;                 ///< W, zero when off
    double speed = 0.0;                 ///< m/s
    double spot_radius = 0.0;           ///< m, 1/e^2
    bool on = false;
    std::vector<PathCorner> path_done;    ///< of the path up to the beam
    std::vector<PathCorner> path_to_come; ///< from the beam to the end
    std::vector<PoolFigures> pools;       ///< the beam's own pool in its own frame, one an isotherm
};

/// The horizontal direction that a beam's pool is measured along and pictures look across: that of its scan,
/// while it dwells the way it came; x if it never moved.
Vec3 level_direction(const BeamSnapshot& beam);

/// Particles picked for output; all arrays have one entry (position: three) a particle, ordered by id.
struct ParticleSample {
    std::vector<double> position;        ///< m, xyz xyz ...
    std::vector<double> temperature;     ///< K, interpolated from the nodes
    std::vector<double> specific_energy; ///< J/kg
    std::vector<double> liquid_fraction; ///< 1
    std::vector<double> phi_hat;         ///< 1, in (-1/2, 1/2)
    std::vector<std::int64_t> id;
    std::vector<std::int32_t> material; ///< index into the run's materials
};

/// Everything a picture, a file or a table of one instant is made from. Immutable once handed on.
struct Snapshot {
    std::string title;
    double time = 0.0; ///< s
    std::int64_t step = 0;
    double dt = 0.0;       ///< s, of the step that led here
    double solidus = 0.0;  ///< K, of the first material
    double liquidus = 0.0; ///< K
    NodeLattice nodes;
    SharedField phi;         ///< m, negative in the material; unchanged while the geometry is
    SharedField phi_hat;     ///< 1
    SharedField mass;        ///< kg; zero: the node has no temperature of its own
    SharedField temperature; ///< K; at nodes without mass extended from their neighbours so that surfaces can
                             ///< be coloured
    double peak_temperature = 0.0; ///< K, hottest node in the material
    double absorbed_energy = 0.0;  ///< J, since the start
    double lost_energy = 0.0;      ///< J, lost from surfaces and beside the material since the start
    std::int64_t liquid_particles = 0;
    std::vector<BeamSnapshot> beams;
    /// The pool of the first beam, without beams the largest; one an isotherm asked for, of which the first
    /// is the liquidus by default.
    std::vector<PoolFigures> pools;
    std::vector<SeparatePool> separate_pools; ///< by isotherm in the order of `pools`, the largest first
    ParticleSample particles;                 ///< empty unless particles are due
};

} // namespace meltscope
