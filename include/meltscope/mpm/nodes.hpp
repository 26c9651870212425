#pragma once

#include "meltscope/aligned.hpp"
#include "meltscope/material/equation_of_state.hpp"
#include "meltscope/mpm/boundary.hpp"
#include "meltscope/mpm/grid.hpp"
#include "meltscope/mpm/particles.hpp"

#include <vector>

namespace meltscope {

/// Entries begin .. end of the nodal fields, in one row along x; multiples of lane_count.
struct NodeSpan {
    std::int64_t begin, end;
};

/// Nodal fields of the step, all grid.size long.
///
/// A node has one temperature. With several materials its energy is shared out so that all are at that
/// temperature: sum_A m_iA e_A(T_i) = (m e)_i, which for constant heat capacities is their capacity-weighted
/// mean temperature and conserves energy exactly. So specific energies are kept a field a material.
///
/// Masses count the particles that are awake. A node that only sleeping ones reach has none; it keeps its
/// temperature and its (m e)_i, of all particles there, until it gets mass.
struct Nodes {
    std::vector<NodeSpan> spans; ///< hold all nodes with mass; what the loops over nodes run through

    Boundary boundary;         ///< that ghosts are folded and mirrored by
    Field mass;                ///< m_i, kg; ghosts beyond faces that do not fix the temperature are folded in
    Field inertia;             ///< m_i with all ghosts folded in; empty unless a face fixes the temperature
    Field mass_energy;         ///< (m e)_i, J
    Field temperature;         ///< T_i, K
    Field increment;           ///< D_i, J
    std::vector<Field> energy; ///< e_i of each material, J/kg; after step 6: e_i* - (1 - b) e_i
    std::vector<Field> new_energy;              ///< e_i* of each material, J/kg
    std::vector<Field> material_mass;           ///< m_i of each material, kg; empty with one material
    std::vector<std::int64_t> mixed;            ///< nodes that hold several materials, ascending
    std::vector<std::int64_t> near_fixed_faces; ///< see nodes_near_fixed_faces

    bool several_materials() const { return !material_mass.empty(); }
};

/// All rows.
std::vector<NodeSpan> all_nodes(const Grid& grid);

/// Calls `work(i)` for every lane group i .. i + lane_count - 1 of the spans.
template <class Work>
void for_each_node_lanes(const std::vector<NodeSpan>& spans, Work work) {
#pragma omp parallel for schedule(static)
    for (std::size_t n = 0; n < spans.size(); ++n)
        for (std::int64_t i = spans[n].begin; i < spans[n].end; i += lane_count)
            work(i);
}

/// Node masses and all else that follows from where the particles are. Mass-energies are zero afterwards.
Nodes make_nodes(const Grid& grid, const Particles& particles, int materials, const Boundary& boundary);

/// The masses alone, of the particles that are awake.
void find_node_masses(const Grid& grid, const Particles& particles, const Boundary& boundary, Nodes& nodes);

/// Adds sum_p N_ip m_p over the particles of `groups`, of one material or of all (-1), to `mass`.
void add_node_mass(const Grid& grid, const Particles& particles, const GroupRuns& groups, int material,
                   Field& mass);

/// Adds sum_p N_ip m_p (e_p + g_p . (x_i - x_p)) over the particles of `groups` to `mass_energy`; see
/// particles_to_grid.
void add_node_energy(const Grid& grid, const Particles& particles, const GroupRuns& groups,
                     const std::vector<Field>* gradient_of, Field& mass_energy);

/// Step 3, P2G: (m e)_i = sum_p N_ip m_p (e_p + g_p . (x_i - x_p)), g_p = sum_i e_i grad N_ip of
/// `gradient_of`, a field a material; without it g_p = 0. Used where step 7's fused pass has not done it: at
/// the start and after a change of the particles.
void particles_to_grid(const Grid& grid, const Particles& particles, const std::vector<Field>* gradient_of,
                       Nodes& nodes);

/// Step 4, Favre mean: e_i = (m e)_i / m_i and T_i = T(e_i) in `spans`; faces of fixed temperature get
/// theirs, ghosts follow. A node without mass keeps its temperature, which is zero where no particle ever
/// was.
void favre_mean(const Grid& grid, const std::vector<EquationOfState>& materials, const Boundary& boundary,
                const std::vector<NodeSpan>& spans, Nodes& nodes);

/// The same for all nodes with mass.
void favre_mean(const Grid& grid, const std::vector<EquationOfState>& materials, const Boundary& boundary,
                Nodes& nodes);

/// The temperature in K at which the materials of a node together hold `total` J: sum_A m_iA e_A(T) = total.
double mixture_temperature(const std::vector<EquationOfState>& materials,
                           const std::vector<Field>& material_mass, std::int64_t node, double total);

} // namespace meltscope
