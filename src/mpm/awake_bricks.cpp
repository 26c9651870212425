#include "meltscope/mpm/awake_bricks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meltscope {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

static_assert(bins_in_brick[0] % lane_count == 0, "a lane group belongs to one brick");

std::int64_t brick_at(const Index3& count, std::int64_t x, std::int64_t y, std::int64_t z) {
    return x + count[0] * (y + count[1] * z);
}

Index3 place_of(const Index3& count, std::int64_t brick) {
    return {brick % count[0], brick / count[0] % count[1], brick / count[0] / count[1]};
}

std::int64_t brick_of(const Grid& grid, const Index3& count, const LaneGroup& group) {
    // The corner is one node below the first bin, and storage starts one node below the box.
    return brick_at(count, group.corner % grid.stride_y / bins_in_brick[0],
                    group.corner % grid.stride_z / grid.stride_y / bins_in_brick[1],
                    group.corner / grid.stride_z / bins_in_brick[2]);
}

/// Calls work(neighbour) for each of the up to 26 bricks that share nodes with `brick`.
template <class Work>
void for_each_neighbour(const Index3& count, std::int64_t brick, Work work) {
    const Index3 at = place_of(count, brick);
    const Index3 low = (at - 1).max(0), high = (at + 1).min(count - 1);
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
        for (std::int64_t y = low[1]; y <= high[1]; ++y)
            for (std::int64_t x = low[0]; x <= high[0]; ++x)
                if (const std::int64_t other = brick_at(count, x, y, z); other != brick)
                    work(other);
}

/// The groups of the chosen bricks.
GroupRuns groups_of(const LaneLayout& layout, const Bricks& bricks, const std::vector<char>& chosen) {
    GroupRuns groups;
    for (int colour = 0; colour < 4; ++colour) {
        groups.colour_start[colour] = std::int64_t(groups.block_start.size());
        for (std::int64_t b = layout.colour_start[colour]; b < layout.colour_start[colour + 1]; ++b) {
            const std::int64_t first_run = std::int64_t(groups.runs.size());
            for (std::int64_t n = bricks.piece_start[b]; n < bricks.piece_start[b + 1]; ++n) {
                const Bricks::Piece& piece = bricks.pieces[n];
                if (!chosen[piece.brick])
                    continue;
                const bool follows = std::int64_t(groups.runs.size()) > first_run &&
                                     groups.runs.back().last_group == piece.groups.first_group;
                if (follows)
                    groups.runs.back().last_group = piece.groups.last_group;
                else
                    groups.runs.push_back(piece.groups);
            }
            if (std::int64_t(groups.runs.size()) > first_run)
                groups.block_start.push_back(first_run);
        }
    }
    groups.colour_start[4] = std::int64_t(groups.block_start.size());
    groups.block_start.push_back(std::int64_t(groups.runs.size()));
    return groups;
}

/// The nodes that the chosen bricks reach, ghosts included, each once; with `whole_lanes` rounded up.
std::vector<NodeSpan> nodes_of(const Grid& grid, const Bricks& bricks, const std::vector<char>& chosen,
                               bool whole_lanes) {
    const Index3& count = bricks.count;
    std::vector<char> any_in_row(count[1] * count[2], 0);
    for (std::int64_t row = 0; row < count[1] * count[2]; ++row)
        any_in_row[row] = std::any_of(&chosen[row * count[0]], &chosen[row * count[0]] + count[0],
                                      [](char c) { return c != 0; });
    // Rows of bricks with a bin next to node row n along an axis.
    const auto rows_near = [&](std::int64_t n, int axis) {
        return std::pair{std::max<std::int64_t>(n - 1, 0) / bins_in_brick[axis],
                         std::min<std::int64_t>(n + 1, grid.cells[axis]) / bins_in_brick[axis]};
    };
    std::vector<NodeSpan> spans;
    std::vector<char> near(count[0] + 1, 0);
    for (std::int64_t k = -1; k <= grid.cells[2] + 1; ++k)
        for (std::int64_t j = -1; j <= grid.cells[1] + 1; ++j) {
            bool any = false;
            const auto [low_y, high_y] = rows_near(j, 1);
            const auto [low_z, high_z] = rows_near(k, 2);
            for (std::int64_t z = low_z; z <= high_z; ++z)
                for (std::int64_t y = low_y; y <= high_y; ++y) {
                    if (!any_in_row[y + count[1] * z])
                        continue;
                    const char* row = &chosen[brick_at(count, 0, y, z)];
                    for (std::int64_t x = 0; x < count[0]; ++x)
                        near[x] = (any ? near[x] : 0) | row[x];
                    any = true;
                }
            if (!any)
                continue;
            const std::int64_t row = grid.index(-1, j, k);
            for (std::int64_t x = 0; x < count[0]; ++x) {
                if (!near[x])
                    continue;
                const std::int64_t first = x;
                while (near[x + 1])
                    ++x;
                std::int64_t end = std::min(bins_in_brick[0] * (x + 1) + 2, grid.cells[0] + 3);
                if (whole_lanes)
                    end = (end + lane_count - 1) / lane_count * lane_count;
                spans.push_back({row + bins_in_brick[0] * first, row + end});
            }
        }
    return spans;
}

void find_pieces(const Grid& grid, const LaneLayout& layout, Bricks& bricks) {
    bricks.piece_start.assign(1, 0);
    for (const LaneBlock& block : layout.blocks) {
        for (std::int64_t g = block.first_group; g < block.last_group; ++g) {
            const std::int64_t brick = brick_of(grid, bricks.count, layout.groups[g]);
            const bool first = std::int64_t(bricks.pieces.size()) == bricks.piece_start.back();
            if (first || bricks.pieces.back().brick != brick)
                bricks.pieces.push_back({brick, {g, g}});
            bricks.pieces.back().groups.last_group = g + 1;
        }
        bricks.piece_start.push_back(std::int64_t(bricks.pieces.size()));
    }
}

void find_temperatures(const Particles& particles, const std::vector<EquationOfState>& materials,
                       Bricks& bricks) {
    bricks.coldest.assign(bricks.count.prod(), infinite);
    bricks.hottest.assign(bricks.count.prod(), -infinite);
    const std::int64_t blocks = std::int64_t(particles.layout.blocks.size());
#pragma omp parallel for schedule(dynamic, 1) // a brick belongs to one block
    for (std::int64_t b = 0; b < blocks; ++b)
        for (std::int64_t n = bricks.piece_start[b]; n < bricks.piece_start[b + 1]; ++n) {
            Lanes coldest(infinite), hottest(-infinite);
            for (std::int64_t g = bricks.pieces[n].groups.first_group; g < bricks.pieces[n].groups.last_group;
                 ++g) {
                const LaneGroup& group = particles.layout.groups[g];
                for (std::int64_t slot = group.first_slot; slot < group.first_slot + group.slots; ++slot) {
                    const auto filled = load(&particles.mass[slot * lane_count]) > 0.0;
                    const Lanes t = materials[group.kind].temperature(
                        load(&particles.specific_energy[slot * lane_count]));
                    coldest = min(coldest, select(filled, t, Lanes(infinite)));
                    hottest = max(hottest, select(filled, t, Lanes(-infinite)));
                }
            }
            const std::int64_t brick = bricks.pieces[n].brick;
            bricks.coldest[brick] = std::min(bricks.coldest[brick], hmin(coldest));
            bricks.hottest[brick] = std::max(bricks.hottest[brick], hmax(hottest));
        }
}

void find_extremes_asleep(Bricks& bricks) {
    bricks.coldest_asleep = infinite;
    bricks.hottest_asleep = -infinite;
    for (std::int64_t b = 0; b < bricks.count.prod(); ++b)
        if (bricks.sleeps(b)) {
            bricks.coldest_asleep = std::min(bricks.coldest_asleep, bricks.coldest[b]);
            bricks.hottest_asleep = std::max(bricks.hottest_asleep, bricks.hottest[b]);
        }
}

void add_to_border(const std::vector<std::int64_t>& woken, Bricks& bricks) {
    for (const std::int64_t brick : woken)
        for_each_neighbour(bricks.count, brick, [&](std::int64_t other) {
            if (bricks.sleeps(other) && !bricks.on_border[other]) {
                bricks.on_border[other] = 1;
                bricks.border.push_back(other);
            }
        });
    std::erase_if(bricks.border, [&](std::int64_t brick) { return bricks.awake[brick] != 0; });
}

/// What the nodes of a brick say to those around it.
struct Rumour {
    double coldest = infinite, hottest = -infinite; ///< K, over its nodes
    bool heated = false;                            ///< through a face of the box
};

bool heat_comes_through_a_face(const Grid& grid, const Boundary& boundary, const Bricks& bricks,
                               double tolerance, std::int64_t brick) {
    const Index3 at = place_of(bricks.count, brick);
    for (int f = 0; f < 6; ++f) {
        const int axis = f / 2;
        const bool at_face =
            f % 2 == 0 ? at[axis] == 0 : bins_in_brick[axis] * (at[axis] + 1) >= grid.cells[axis];
        const FaceCondition& face = boundary[f];
        if (!at_face)
            continue;
        if (face.kind == FaceCondition::Kind::fixed_flux && face.flux != 0.0)
            return true;
        // One that is awake shows by its nodes what convection has done.
        if (face.kind == FaceCondition::Kind::convection && bricks.sleeps(brick) &&
            (bricks.hottest[brick] - face.temperature > tolerance ||
             face.temperature - bricks.coldest[brick] > tolerance))
            return true;
    }
    return false;
}

Rumour listen_to(const Grid& grid, const Boundary& boundary, const Bricks& bricks, const Nodes& nodes,
                 double tolerance, std::int64_t brick) {
    Rumour rumour;
    const Index3 at = place_of(bricks.count, brick);
    Index3 low, high; // nodes
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::max<std::int64_t>(bins_in_brick[axis] * at[axis] - 1, 0);
        high[axis] = std::min(bins_in_brick[axis] * (at[axis] + 1), grid.cells[axis]);
    }
    for (std::int64_t k = low[2]; k <= high[2]; ++k)
        for (std::int64_t j = low[1]; j <= high[1]; ++j)
            for (std::int64_t i = grid.index(low[0], j, k); i <= grid.index(high[0], j, k); ++i) {
                const double t = nodes.temperature[i];
                rumour.coldest = std::min(rumour.coldest, t != 0.0 ? t : infinite); // zero: no particle there
                rumour.hottest = std::max(rumour.hottest, t != 0.0 ? t : -infinite);
            }
    rumour.heated = heat_comes_through_a_face(grid, boundary, bricks, tolerance, brick);
    return rumour;
}

/// In one step heat gets five bins further than the nodes whose temperatures differ: flux, undoing of the
/// lumped mass and G2P reach out by one and a half each. So a brick heeds what its neighbours' nodes say,
/// too.
bool is_restless(const Bricks& bricks, const std::vector<Rumour>& rumours,
                 const std::vector<std::int64_t>& rumour_of, double tolerance, double lowest_solidus,
                 std::int64_t brick) {
    const double coldest = bricks.coldest[brick], hottest = bricks.hottest[brick];
    bool restless = hottest - coldest > tolerance || hottest >= lowest_solidus;
    const auto heed = [&](std::int64_t other) {
        if (rumour_of[other] < 0)
            return;
        const Rumour& rumour = rumours[rumour_of[other]];
        restless = restless || rumour.heated || rumour.hottest - coldest > tolerance ||
                   hottest - rumour.coldest > tolerance;
    };
    heed(brick);
    for_each_neighbour(bricks.count, brick, heed);
    return restless;
}

/// Makes the masses of the nodes in `changed` anew, bit for bit what find_node_masses gives there. `groups`
/// holds all that are awake and reach those nodes, `reach` is that and the ghosts beyond, which are folded
/// in. `take(node, mass)` comes before the change.
template <class Take>
void sum_masses(const Grid& grid, const Boundary& boundary, const Particles& particles,
                const GroupRuns& groups, const std::vector<NodeSpan>& reach,
                const std::vector<NodeSpan>& changed, Nodes& nodes, Take take) {
    Field& scratch = nodes.new_energy[0]; // free until e* is known
    const auto sum_up = [&](int material, AtFixedFaces at_fixed, auto&& put) {
        for (const NodeSpan& span : reach)
            std::fill(scratch.begin() + span.begin, scratch.begin() + span.end, 0.0);
        add_node_mass(grid, particles, groups, material, scratch);
        fold_ghosts(grid, boundary, at_fixed, scratch);
#pragma omp parallel for schedule(static)
        for (std::size_t n = 0; n < changed.size(); ++n)
            for (std::int64_t i = changed[n].begin; i < changed[n].end; ++i)
                put(i, scratch[i]);
    };
    sum_up(-1, AtFixedFaces::leave, [&](std::int64_t i, double mass) {
        take(i, mass);
        nodes.mass[i] = mass;
    });
    if (!nodes.inertia.empty())
        sum_up(-1, AtFixedFaces::even, [&](std::int64_t i, double mass) { nodes.inertia[i] = mass; });
    for (std::size_t a = 0; a < nodes.material_mass.size(); ++a)
        sum_up(int(a), AtFixedFaces::leave,
               [&](std::int64_t i, double mass) { nodes.material_mass[a][i] = mass; });
}

} // namespace

Index3 brick_counts(const Grid& grid) {
    Index3 count;
    for (int axis = 0; axis < 3; ++axis)
        count[axis] = grid.cells[axis] / bins_in_brick[axis] + 1; // bins 0 .. cells
    return count;
}

Bricks make_bricks(const Grid& grid, const Particles& particles,
                   const std::vector<EquationOfState>& materials) {
    Bricks bricks;
    bricks.count = brick_counts(grid);
    bricks.awake.assign(bricks.count.prod(), 0);
    bricks.on_border.assign(bricks.count.prod(), 0);
    find_pieces(grid, particles.layout, bricks);
    find_temperatures(particles, materials, bricks);
    find_extremes_asleep(bricks);
    return bricks;
}

std::vector<char> with_neighbours(const Bricks& bricks, const std::vector<char>& chosen) {
    std::vector<char> wider = chosen;
    for (std::size_t brick = 0; brick < chosen.size(); ++brick)
        if (chosen[brick])
            for_each_neighbour(bricks.count, std::int64_t(brick),
                               [&](std::int64_t other) { wider[other] = 1; });
    return wider;
}

std::vector<std::int64_t> bricks_of_bins(const Bricks& bricks, const Index3& low, const Index3& high) {
    Index3 first, last;
    for (int axis = 0; axis < 3; ++axis) {
        first[axis] = std::max<std::int64_t>(low[axis], 0) / bins_in_brick[axis];
        last[axis] = std::min(high[axis] / bins_in_brick[axis], bricks.count[axis] - 1);
    }
    std::vector<std::int64_t> result;
    for (std::int64_t z = first[2]; z <= last[2]; ++z)
        for (std::int64_t y = first[1]; y <= last[1]; ++y)
            for (std::int64_t x = first[0]; x <= last[0]; ++x)
                result.push_back(brick_at(bricks.count, x, y, z));
    return result;
}

std::vector<std::int64_t> restless_bricks(const Grid& grid, const Boundary& boundary, const Bricks& bricks,
                                          const Nodes& nodes, double tolerance, double lowest_solidus,
                                          std::span<const std::int64_t> candidates) {
    std::vector<std::int64_t> rumour_of(bricks.awake.size(), -1), heard;
    const auto hear = [&](std::int64_t brick) {
        if (rumour_of[brick] < 0 && bricks.holds_particles(brick)) {
            rumour_of[brick] = std::int64_t(heard.size());
            heard.push_back(brick);
        }
    };
    for (const std::int64_t brick : candidates) {
        hear(brick);
        for_each_neighbour(bricks.count, brick, hear);
    }
    std::vector<Rumour> rumours(heard.size());
#pragma omp parallel for schedule(static)
    for (std::size_t n = 0; n < heard.size(); ++n)
        rumours[n] = listen_to(grid, boundary, bricks, nodes, tolerance, heard[n]);
    std::vector<std::int64_t> result;
    for (const std::int64_t brick : candidates)
        if (bricks.sleeps(brick) && is_restless(bricks, rumours, rumour_of, tolerance, lowest_solidus, brick))
            result.push_back(brick);
    return result;
}

std::vector<std::int64_t> sleeping_bricks(const Bricks& bricks) {
    std::vector<std::int64_t> sleeping;
    for (std::int64_t b = 0; b < std::int64_t(bricks.awake.size()); ++b)
        if (bricks.sleeps(b))
            sleeping.push_back(b);
    return sleeping;
}

void wake(const Grid& grid, const Boundary& boundary, const std::vector<EquationOfState>& materials,
          std::span<const std::int64_t> which, Bricks& bricks, Particles& particles, Nodes& nodes) {
    std::vector<std::int64_t> woken;
    std::vector<char> is_woken(bricks.awake.size(), 0), is_near = is_woken;
    for (const std::int64_t brick : which)
        if (bricks.sleeps(brick)) {
            woken.push_back(brick);
            is_woken[brick] = bricks.awake[brick] = 1;
        }
    if (woken.empty())
        return;
    for (const std::int64_t brick : woken) {
        is_near[brick] = 1;
        for_each_neighbour(bricks.count, brick,
                           [&](std::int64_t other) { is_near[other] = bricks.awake[other]; });
    }
    particles.awake = groups_of(particles.layout, bricks, bricks.awake);
    nodes.spans = nodes_of(grid, bricks, bricks.awake, true);

    // Between steps D is zero and can take the sums. A node that had no mass held all particles' energy.
    const std::vector<NodeSpan> changed = nodes_of(grid, bricks, is_woken, false);
    Field& energy = nodes.increment;
    for (const NodeSpan& span : changed)
        std::fill(energy.begin() + span.begin, energy.begin() + span.end, 0.0);
    add_node_energy(grid, particles, groups_of(particles.layout, bricks, is_woken), nullptr, energy);
    fold_ghosts(grid, boundary, AtFixedFaces::leave, energy);
    sum_masses(grid, boundary, particles, groups_of(particles.layout, bricks, is_near),
               nodes_of(grid, bricks, with_neighbours(bricks, is_near), false), changed, nodes,
               [&](std::int64_t i, double mass) {
                   if (nodes.mass[i] > 0.0)
                       nodes.mass_energy[i] += energy[i];
                   else if (mass > 0.0)
                       nodes.mass_energy[i] = energy[i];
                   energy[i] = 0.0;
               });
    favre_mean(grid, materials, boundary, nodes_of(grid, bricks, is_woken, true), nodes);
    add_to_border(woken, bricks);
    find_extremes_asleep(bricks);
}

void put_to_sleep(const Grid& grid, const Boundary& boundary, Bricks& bricks, Particles& particles,
                  Nodes& nodes) {
    particles.awake = groups_of(particles.layout, bricks, bricks.awake);
    nodes.spans = nodes_of(grid, bricks, bricks.awake, true);
    find_node_masses(grid, particles, boundary, nodes);
    std::vector<std::int64_t> awake;
    for (std::int64_t b = 0; b < std::int64_t(bricks.awake.size()); ++b)
        if (bricks.awake[b])
            awake.push_back(b);
    add_to_border(awake, bricks);
    find_extremes_asleep(bricks);
}

} // namespace meltscope
