#pragma once

#include "meltscope/mpm/level_set.hpp"
#include "meltscope/mpm/nodes.hpp"

namespace meltscope {

/// Particles with |phi_hat_p| up to this carry the surface's heat.
inline constexpr double surface_gate = 0.45;

/// The pieces of free surface that particles stand for, and how to reach them from the nodes.
struct SurfaceElements {
    std::vector<std::int64_t> particle; ///< index into Particles (one by one)
    std::vector<Vec3> point;            ///< x_s in m, foot point of the particle on the surface
    std::vector<Vec3> normal;           ///< n_p, unit, out of the material
    std::vector<double> area;           ///< a_p, m^2

    LaneLayout layout; ///< of the points where the heat goes in; the kind of a group is its material
    Field offset_x, offset_y, offset_z; ///< layout order, in cells
    Field normalization;                ///< layout order: 1 / (sum of N_i over nodes with mass)

    std::int64_t count() const { return std::int64_t(particle.size()); }
};

/// Heat of some of the elements.
struct ElementHeat {
    std::vector<std::int64_t> element; ///< each at most once
    std::vector<double> amount;        ///< W or J
};

/// What the particles near the surface have of it. Their lane groups' entries lie end to end: what is worked
/// out for them alone needs no array over all particles.
struct SurfaceAreas {
    std::vector<std::int64_t> group; ///< lane groups that may hold particles of the surface, ascending
    std::vector<std::int64_t> first; ///< of each lane group of the layout: its first entry here, -1: none
    Field area;                      ///< a_p, m^2; zero for particles beyond the gate
};

/// Steps 1 and 2 and what follows from them; stands as long as the particles do.
struct FreeSurface {
    Field phi; ///< phi_i, m; phi_hat_i follows from it, see regularized()
    SurfaceElements elements;
};

/// Step 2: the areas that the particles near the surface stand for.
///
/// A node's share of the surface is A_i = dx^3 |grad phi_i| hat(phi_i), hat(s) = max(0, 1 - |s|/w)/w, w =
/// (|n_x| + |n_y| + |n_z|) dx, and a particle takes a_p = sum_i A_i N_ip s_p / sum_q N_iq s_q with s_p = v_p
/// |sum_i phi_hat_i grad N_ip| if |phi_hat_p| <= 0.45.
SurfaceAreas find_surface_areas(const Grid& grid, const Particles& particles, const Field& phi,
                                const Field& phi_hat);

/// Finds the free surface. `at_surface`: heat goes in at the foot points x_s; otherwise in the volume of the
/// particles of the band.
FreeSurface find_free_surface(const Grid& grid, const Particles& particles, const Nodes& nodes,
                              const LevelSetOptions& options, bool at_surface);

/// Step 5, surface terms: D_i += energy_s N_i(x_s) / sum_j N_j(x_s), nodes without mass left out.
/// `energy`: J a surface element, one by one.
void deposit(const Grid& grid, const SurfaceElements& elements, std::span<const double> energy, Nodes& nodes);

/// The same for some of the elements, J.
void deposit(const Grid& grid, const SurfaceElements& elements, const ElementHeat& energy, Nodes& nodes);

/// Interpolates a nodal field, its ghosts set, to each surface element, one by one: with the weights of
/// deposit().
void interpolate_to_surface(const Grid& grid, const SurfaceElements& elements, const Field& field,
                            std::vector<double>& value);

/// Temperature in K at each surface element, one by one: the nodes' with the weights of deposit().
void surface_temperatures(const Grid& grid, const SurfaceElements& elements, const Nodes& nodes,
                          std::vector<double>& temperature);

} // namespace meltscope
