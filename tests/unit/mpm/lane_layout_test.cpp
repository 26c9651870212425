#include "meltscope/mpm/lane_layout.hpp"

#include "reference/driver.hpp"

#include <gtest/gtest.h>

#include <set>

namespace meltscope {
namespace {

using namespace verification;

const Grid& sample_grid() {
    static const Grid grid = make_grid(Vec3(-1.0, 2.0, 0.5), 0.1, {19, 11, 13});
    return grid;
}

/// A jittered ball above a lattice-filled slab of two materials.
ParticleList sample_points() {
    const Grid& grid = sample_grid();
    ParticleList list = lattice_points(
        grid, 2, [](const Vec3& x) { return x[2] < 1.0 || (x - Vec3(0.0, 2.5, 1.4)).norm() < 0.3; });
    for (std::int64_t q = 0; q < list.size(); ++q) {
        if (list.position[q][2] > 1.0)
            list.position[q] += 0.01 * Vec3(std::sin(q), std::cos(q), std::sin(2.0 * q));
        list.material[q] = list.position[q][0] < -0.3 ? 1 : 0;
    }
    return list;
}

TEST(LaneLayout, every_point_has_a_place_of_its_own_in_a_group_of_its_kind_and_bin) {
    const Grid& grid = sample_grid();
    const ParticleList list = sample_points();
    const LaneLayout layout = make_lane_layout(grid, list.position, list.material, 2);
    ASSERT_EQ(layout.place.size(), list.position.size());
    EXPECT_EQ(std::set<std::int64_t>(layout.place.begin(), layout.place.end()).size(), layout.place.size());
    std::int64_t slots = 0;
    for (const LaneGroup& group : layout.groups) {
        EXPECT_EQ(group.first_slot, slots);
        slots += group.slots;
    }
    EXPECT_EQ(slots, layout.slots);
    for (std::size_t q = 0; q < layout.place.size(); ++q) {
        const std::int64_t slot = layout.place[q] / lane_count, lane = layout.place[q] % lane_count;
        const auto group = std::find_if(layout.groups.begin(), layout.groups.end(), [&](const LaneGroup& g) {
            return slot >= g.first_slot && slot < g.first_slot + g.slots;
        });
        ASSERT_NE(group, layout.groups.end());
        EXPECT_EQ(group->kind, list.material[q]);
        const BinPlace bin = bin_place(grid, list.position[q]);
        EXPECT_EQ(group->corner + lane, grid.index(bin.node[0] - 1, bin.node[1] - 1, bin.node[2] - 1));
    }
}

TEST(LaneLayout, lattice_groups_hold_their_points_in_the_order_of_the_lattice) {
    const Grid& grid = sample_grid();
    const ParticleList list = sample_points();
    const LaneLayout layout = make_lane_layout(grid, list.position, list.material, 2);
    const std::vector<double> at = lattice_offsets(2);
    std::int64_t on_lattice = 0;
    for (std::size_t q = 0; q < layout.place.size(); ++q)
        for (const LaneGroup& group : layout.groups) {
            const std::int64_t s = layout.place[q] / lane_count - group.first_slot;
            if (!group.on_lattice || s < 0 || s >= group.slots)
                continue;
            const BinPlace bin = bin_place(grid, list.position[q]);
            EXPECT_NEAR(bin.offset[0], at[s % 2], 1e-6);
            EXPECT_NEAR(bin.offset[1], at[s / 2 % 2], 1e-6);
            EXPECT_NEAR(bin.offset[2], at[s / 4], 1e-6);
            ++on_lattice;
        }
    EXPECT_GT(on_lattice, std::int64_t(layout.place.size()) / 2);
    EXPECT_LT(on_lattice, std::int64_t(layout.place.size())) << "the ball is no lattice";
}

TEST(LaneLayout, offsets_lead_from_the_bins_nodes_to_the_particles_on_the_lattice_and_off_it) {
    const Grid& grid = sample_grid();
    ParticleList list = sample_points();
    list.mass.assign(list.position.size(), 1.0);
    list.specific_energy = list.mass;
    const Particles particles = make_particles(grid, list, 2);
    std::array<std::int64_t, 2> met{};
    for (std::int64_t q = 0; q < particles.count(); ++q) {
        const std::int64_t at = particles.layout.place[q], slot = at / lane_count;
        const auto group = std::find_if(
            particles.layout.groups.begin(), particles.layout.groups.end(),
            [&](const LaneGroup& g) { return slot >= g.first_slot && slot < g.first_slot + g.slots; });
        const std::array<std::int32_t, 3> node = bin_place(grid, particles.position[q]).node;
        const Vec3 place =
            grid.position(node[0], node[1], node[2]) + grid.dx * offset_in_bin(particles, *group, at);
        EXPECT_LT((place - particles.position[q]).norm(), 1e-6 * grid.dx);
        ++met[group->on_lattice];
    }
    EXPECT_GT(met[0], 0);
    EXPECT_GT(met[1], 0);
}

TEST(LaneLayout, ids_are_kept_whether_they_are_the_usual_ones_or_not) {
    ParticleList list = sample_points();
    list.mass.assign(list.position.size(), 1.0);
    list.specific_energy = list.mass;
    EXPECT_EQ(list_particles(make_particles(sample_grid(), list, 2)).id, list.id);
    for (std::int64_t& id : list.id)
        id = 3 * id + 5;
    const Particles particles = make_particles(sample_grid(), list, 2);
    EXPECT_EQ(list_particles(particles).id, list.id);
    EXPECT_EQ(particles.id_of(2), 11);
}

TEST(LaneLayout, padding_has_neither_mass_nor_volume) {
    const Grid& grid = sample_grid();
    ParticleList list = sample_points();
    const std::vector<EquationOfState> materials(2, make_equation_of_state(constant_material()));
    set_state(
        materials, [](const Vec3&) { return 300.0; }, list);
    const Particles particles = make_particles(grid, list, 2);
    std::vector<char> taken(particles.layout.size(), 0);
    for (const std::int64_t at : particles.layout.place)
        taken[at] = 1;
    std::int64_t padding = 0;
    for (std::int64_t at = 0; at < particles.layout.size(); ++at)
        if (!taken[at]) {
            EXPECT_EQ(particles.mass[at], 0.0);
            EXPECT_EQ(particles.volume[at], 0.0);
            ++padding;
        }
    EXPECT_GE(padding, 0);
    const ParticleList back = list_particles(particles);
    EXPECT_EQ(back.position, list.position);
    EXPECT_EQ(back.mass, list.mass);
    EXPECT_EQ(back.volume, list.volume);
    EXPECT_EQ(back.specific_energy, list.specific_energy);
    EXPECT_EQ(back.material, list.material);
}

TEST(LaneLayout, blocks_of_one_colour_share_no_node) {
    const Grid& grid = sample_grid();
    const LaneLayout layout = make_lane_layout(grid, sample_points().position, {}, 2);
    std::int64_t groups = 0;
    for (int colour = 0; colour < 4; ++colour) {
        std::vector<std::int64_t> owner(grid.size, -1);
        for (std::int64_t b = layout.colour_start[colour]; b < layout.colour_start[colour + 1]; ++b)
            for (std::int64_t g = layout.blocks[b].first_group; g < layout.blocks[b].last_group;
                 ++g, ++groups)
                for (int k = 0; k < 3; ++k)
                    for (int j = 0; j < 3; ++j)
                        for (int i = 0; i < lane_count + 2; ++i) {
                            std::int64_t& node =
                                owner[layout.groups[g].corner + i + j * grid.stride_y + k * grid.stride_z];
                            EXPECT_TRUE(node == -1 || node == b);
                            node = b;
                        }
    }
    EXPECT_EQ(groups, std::int64_t(layout.groups.size())) << "every group is in a block";
    EXPECT_EQ(layout.colour_start[4], std::int64_t(layout.blocks.size()));
}

TEST(LaneLayout, points_on_the_walls_belong_to_the_walls_nodes) {
    const Grid& grid = sample_grid();
    const BinPlace low = bin_place(grid, grid.origin), high = bin_place(grid, grid.upper_corner());
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(low.node[axis], 0);
        EXPECT_EQ(high.node[axis], grid.cells[axis]);
        EXPECT_NEAR(low.offset[axis], 0.0, 1e-12);
        EXPECT_NEAR(high.offset[axis], 0.0, 1e-12);
    }
    EXPECT_THROW(bin_place(grid, grid.origin - Vec3(0.2, 0.0, 0.0)), std::out_of_range);
}

TEST(LaneLayout, points_on_the_border_of_two_bins_fall_to_one_side_whatever_their_round_off) {
    const Grid& grid = sample_grid();
    for (const double off : {-1e-12, 0.0, 1e-12}) {
        const BinPlace bin =
            bin_place(grid, grid.position(4, 4, 4) + Vec3::Constant(0.5 * grid.dx + off * grid.dx));
        EXPECT_EQ(bin.node[0], 5);
        EXPECT_EQ(bin.offset[0], -0.5);
        EXPECT_EQ(BSpline<double>(bin.offset[0]).value[2], 0.0);
    }
}

} // namespace
} // namespace meltscope
