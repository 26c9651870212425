#include "meltscope/mpm/particles.hpp"

#include <cmath>
#include <numeric>

namespace meltscope {
namespace {

/// Where a particle's volume differs from a lattice point's share of a cell by no more than this part of it,
/// the difference is round-off.
constexpr double round_off = 1e-13;

/// Along each axis, of each lattice point of a bin and each node: 1 where the point lies in the box, else 0.
std::array<std::vector<Field>, 3> lattice_points_in_box(const Grid& grid,
                                                        const std::vector<double>& offsets) {
    std::array<std::vector<Field>, 3> in_box;
    for (int axis = 0; axis < 3; ++axis)
        for (const double offset : offsets) {
            Field& of_node = in_box[axis].emplace_back(grid.cells[axis] + 1 + lane_count, 0.0);
            for (std::int64_t n = 0; n <= grid.cells[axis]; ++n)
                of_node[n] = double(n) + offset > 0.0 && double(n) + offset < double(grid.cells[axis]);
        }
    return in_box;
}

/// Whether all lattice points that the box has in a group's bins are there, each with its share of a cell.
bool is_full(const Grid& grid, const Particles& particles, const std::array<std::vector<Field>, 3>& in_box,
             const LaneGroup& group) {
    if (!group.on_lattice)
        return false;
    const std::int64_t i = group.corner % grid.stride_y, j = group.corner % grid.stride_z / grid.stride_y,
                       k = group.corner / grid.stride_z;
    const double share = grid.dx * grid.dx * grid.dx / double(group.slots);
    const double* volume = &particles.volume[group.first_slot * lane_count];
    for (const Field& z : in_box[2])
        for (const Field& y : in_box[1])
            for (const Field& x : in_box[0]) {
                const Lanes expected = share * y[j] * z[k] * load(&x[i]);
                if (any_of(abs(load(volume) - expected) > round_off * share))
                    return false;
                volume += lane_count;
            }
    return true;
}

std::vector<char> find_full_groups(const Grid& grid, const Particles& particles) {
    const auto& groups = particles.layout.groups;
    const auto in_box = lattice_points_in_box(grid, particles.lattice_offset);
    std::vector<char> full(groups.size());
#pragma omp parallel for schedule(static)
    for (std::size_t g = 0; g < groups.size(); ++g)
        full[g] = is_full(grid, particles, in_box, groups[g]);
    return full;
}

} // namespace

Particles make_particles(const Grid& grid, ParticleList list, int lattice) {
    Particles particles;
    particles.layout = make_lane_layout(grid, list.position, list.material, lattice);
    particles.awake = all_groups(particles.layout);
    particles.lattice = lattice;
    particles.lattice_offset = lattice_offsets(lattice);
    const std::int64_t size = particles.layout.size();
    for (Field* field : {&particles.mass, &particles.volume, &particles.specific_energy})
        field->assign(size, 0.0);
    for (Field* field : {&particles.offset_x, &particles.offset_y, &particles.offset_z})
        field->assign(particles.layout.loose_slots * lane_count, 0.0);
    std::vector<std::int64_t> loose_slot(particles.layout.slots, -1);
    for (const LaneGroup& group : particles.layout.groups)
        if (!group.on_lattice)
            std::iota(&loose_slot[group.first_slot], &loose_slot[group.first_slot] + group.slots,
                      group.first_loose);
#pragma omp parallel for schedule(static)
    for (std::int64_t q = 0; q < list.size(); ++q) {
        const std::int64_t at = particles.layout.place[q];
        particles.mass[at] = list.mass[q];
        particles.volume[at] = list.volume[q];
        particles.specific_energy[at] = list.specific_energy[q];
        const std::int64_t loose = loose_slot[at / lane_count];
        if (loose < 0)
            continue;
        const BinPlace place = bin_place(grid, list.position[q]);
        particles.offset_x[loose * lane_count + at % lane_count] = place.offset[0];
        particles.offset_y[loose * lane_count + at % lane_count] = place.offset[1];
        particles.offset_z[loose * lane_count + at % lane_count] = place.offset[2];
    }
    particles.full = find_full_groups(grid, particles);
    if (!list.powder.empty()) {
        particles.powder.assign(size, 0.0);
        for (std::int64_t q = 0; q < list.size(); ++q)
            particles.powder[particles.layout.place[q]] = list.powder[q] ? 1.0 : 0.0;
    }
    particles.position = std::move(list.position);
    // Ascending from 0 to count - 1 they need no memory.
    if (!list.id.empty() && (list.id.front() != 0 || list.id.back() != particles.count() - 1))
        particles.id = std::move(list.id);
    particles.material = std::move(list.material);
    return particles;
}

Vec3 offset_in_bin(const Particles& particles, const LaneGroup& group, std::int64_t at) {
    const std::int64_t slot = at / lane_count - group.first_slot;
    if (group.on_lattice) {
        const std::int64_t n = particles.lattice;
        return {particles.lattice_offset[slot % n], particles.lattice_offset[slot / n % n],
                particles.lattice_offset[slot / (n * n)]};
    }
    const std::int64_t loose = (group.first_loose + slot) * lane_count + at % lane_count;
    return {particles.offset_x[loose], particles.offset_y[loose], particles.offset_z[loose]};
}

ParticleList list_particles(const Particles& particles) {
    ParticleList list;
    list.position = particles.position;
    list.id.resize(particles.count());
    for (std::int64_t q = 0; q < particles.count(); ++q)
        list.id[q] = particles.id_of(q);
    list.material = particles.material;
    const std::int64_t count = particles.count();
    list.mass.resize(count);
    list.volume.resize(count);
    list.specific_energy.resize(count);
#pragma omp parallel for schedule(static)
    for (std::int64_t q = 0; q < count; ++q) {
        const std::int64_t at = particles.layout.place[q];
        list.mass[q] = particles.mass[at];
        list.volume[q] = particles.volume[at];
        list.specific_energy[q] = particles.specific_energy[at];
    }
    if (!particles.powder.empty()) {
        list.powder.resize(count);
        for (std::int64_t q = 0; q < count; ++q)
            list.powder[q] = particles.powder[particles.layout.place[q]] > 0.0;
    }
    return list;
}

double total_energy(const Particles& particles) {
    // One partial sum a block of the layout, then the blocks in order: the same for any number of threads.
    const auto& blocks = particles.layout.blocks;
    std::vector<double> partial(blocks.size());
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        if (blocks[b].first_group == blocks[b].last_group)
            continue;
        const LaneGroup& first = particles.layout.groups[blocks[b].first_group];
        const LaneGroup& last = particles.layout.groups[blocks[b].last_group - 1];
        Lanes sum(0.0);
        for (std::int64_t slot = first.first_slot; slot < last.first_slot + last.slots; ++slot)
            sum += load(&particles.mass[slot * lane_count]) *
                   load(&particles.specific_energy[slot * lane_count]);
        partial[b] = reduce(sum);
    }
    double total = 0.0;
    for (const double sum : partial)
        total += sum;
    return total;
}

} // namespace meltscope
