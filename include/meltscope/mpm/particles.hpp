#pragma once

#include "meltscope/aligned.hpp"
#include "meltscope/mpm/lane_layout.hpp"

#include <cstdint>
#include <vector>

namespace meltscope {

/// Particles one by one, in the order of their ids: how they are made, saved and reported.
struct ParticleList {
    std::vector<Vec3> position;          ///< x_p, m
    std::vector<double> mass;            ///< m_p, kg
    std::vector<double> volume;          ///< v_p, m^3
    std::vector<double> specific_energy; ///< e_p, J/kg
    std::vector<std::int64_t> id;        ///< ascending
    std::vector<std::int16_t> material;  ///< index into the run's materials
    std::vector<char> powder; ///< 1: homogenised powder that has not melted yet; empty: there is none

    std::int64_t size() const { return std::int64_t(position.size()); }
};

/// Particles as the step works on them. What never changes stays one by one, in the order of ids; what the
/// passes read is kept in the order of a lane layout, padding with zero mass and volume: entry
/// layout.place[q] is particle q's.
struct Particles {
    std::vector<Vec3> position;         ///< x_p, m; one by one
    std::vector<std::int64_t> id;       ///< one by one, ascending; empty: 0, 1, 2, ..., as runs number them
    std::vector<std::int16_t> material; ///< one by one

    LaneLayout layout;
    GroupRuns awake;                    ///< the groups that take part in the step
    int lattice = 0;                    ///< points a cell along an axis of the lattice groups
    std::vector<double> lattice_offset; ///< of these points from the bin's node along an axis, in cells
    /// x_p from the bin's node, in cells, of the groups that are not on the lattice: entry
    /// (group.first_loose + slot) * lane_count + lane is that of the group's `slot`.
    Field offset_x, offset_y, offset_z;
    Field mass;            ///< m_p, kg
    Field volume;          ///< v_p, m^3
    Field specific_energy; ///< e_p, J/kg
    /// Of each group: all points that the lattice has in its bins, and in the box, are there, each with its
    /// share of a cell. No free surface passes between such groups.
    std::vector<char> full;
    /// 1: homogenised powder that has not melted yet, 0: bulk; empty: there never was powder. Such a particle
    /// stands for its whole volume; its mass is that of the powder in it.
    Field powder;

    std::int64_t count() const { return std::int64_t(position.size()); }
    std::int64_t id_of(std::int64_t q) const { return id.empty() ? q : id[q]; }
};

/// Lays particles out. `lattice`: see make_lane_layout. Throws std::out_of_range if one lies outside the
/// grid's box.
Particles make_particles(const Grid& grid, ParticleList list, int lattice);

/// x_p from its bin's node, in cells, of a group's entry `at`.
Vec3 offset_in_bin(const Particles& particles, const LaneGroup& group, std::int64_t at);

/// The particles one by one again, with their present energies.
ParticleList list_particles(const Particles& particles);

/// sum of m_p e_p in J, added up in an order that does not depend on the number of threads.
double total_energy(const Particles& particles);

} // namespace meltscope
