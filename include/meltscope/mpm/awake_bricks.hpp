#pragma once

#include "meltscope/mpm/nodes.hpp"

#include <array>
#include <span>
#include <vector>

namespace meltscope {

/// Bins of a brick along x, y and z. The same for every SIMD width, and a block of the lane layout is a row
/// of bricks along x.
inline constexpr std::array<std::int64_t, 3> bins_in_brick{8, 4, 4};

/// The domain in bricks of bins, and which of them take part in the step. Particles in the others sleep: to
/// those awake they are not there, and the border between the two is like any other adiabatic surface. So all
/// sums close among those awake, and energy is conserved whatever sleeps. A brick wakes where heat arrives,
/// and stays awake.
struct Bricks {
    Index3 count = Index3::Zero();
    std::vector<char> awake; ///< x fastest; with the particles' and nodes' energies the state of a run

    /// Groups of one brick that follow on each other in the layout.
    struct Piece {
        std::int64_t brick;
        LaneBlock groups;
    };

    // Derived from the particles and from `awake`.
    std::vector<Piece> pieces;             ///< in the order of the layout
    std::vector<std::int64_t> piece_start; ///< first piece of each of the layout's blocks, and the end
    std::vector<double> coldest, hottest;  ///< K, of the particles' own energies; inf and -inf: it holds none
    std::vector<std::int64_t> border;      ///< bricks that sleep beside one that is awake
    std::vector<char> on_border;           ///< the same, one a brick
    double coldest_asleep = 0.0, hottest_asleep = 0.0; ///< K, over all that sleep; inf and -inf: none does

    bool holds_particles(std::int64_t brick) const { return coldest[brick] <= hottest[brick]; }
    bool sleeps(std::int64_t brick) const { return !awake[brick] && holds_particles(brick); }
};

/// Bricks of a grid's bins along each axis.
Index3 brick_counts(const Grid& grid);

/// The particles as bricks, all asleep.
Bricks make_bricks(const Grid& grid, const Particles& particles,
                   const std::vector<EquationOfState>& materials);

/// The chosen bricks (one char a brick) and those that share nodes with them.
std::vector<char> with_neighbours(const Bricks& bricks, const std::vector<char>& chosen);

/// Bricks, ascending, that hold one of the bins from `low` to `high` (both inclusive, clipped to the domain).
std::vector<std::int64_t> bricks_of_bins(const Bricks& bricks, const Index3& low, const Index3& high);

/// Those of `candidates` that must not sleep on, in their order: in the brick or one beside it a node differs
/// from the brick's particles by more than `tolerance` (K) or heat comes through a face of the box; or the
/// brick has particles that differ from each other or have reached `lowest_solidus` (K; mushy material may
/// hold different energies at one temperature).
std::vector<std::int64_t> restless_bricks(const Grid& grid, const Boundary& boundary, const Bricks& bricks,
                                          const Nodes& nodes, double tolerance, double lowest_solidus,
                                          std::span<const std::int64_t> candidates);

/// All bricks that sleep, ascending.
std::vector<std::int64_t> sleeping_bricks(const Bricks& bricks);

/// Takes the sleeping bricks of `which` in: their particles give their energies to the nodes, whose
/// temperatures follow.
void wake(const Grid& grid, const Boundary& boundary, const std::vector<EquationOfState>& materials,
          std::span<const std::int64_t> which, Bricks& bricks, Particles& particles, Nodes& nodes);

/// Puts all to sleep that `bricks` does not have awake: from now on `nodes` count only particles that are
/// awake. Nodes without mass keep their temperature and (m e)_i; those of the others must be found anew from
/// the (m e)_i of the particles that are awake.
void put_to_sleep(const Grid& grid, const Boundary& boundary, Bricks& bricks, Particles& particles,
                  Nodes& nodes);

} // namespace meltscope
