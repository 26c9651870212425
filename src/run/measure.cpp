#include "meltscope/run/measure.hpp"

#include "meltscope/mpm/group_stencils.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace meltscope {
namespace {

/// Layers of nodes beyond the material that get a temperature, so that surfaces can be coloured and cut.
constexpr int extended_layers = 3;

/// Copies the box's nodes out of a padded field.
std::vector<double> without_padding(const Grid& grid, const Field& field) {
    const Index3 n = grid.cells + 1;
    std::vector<double> result(n.prod());
#pragma omp parallel for schedule(static)
    for (std::int64_t k = 0; k < n[2]; ++k)
        for (std::int64_t j = 0; j < n[1]; ++j)
            std::copy_n(&field[grid.index(0, j, k)], n[0], &result[n[0] * (j + n[1] * k)]);
    return result;
}

/// Continues the node temperatures into nodes without mass, layer by layer, by the mean of the neighbours
/// that have one; what is further off gets `rest`.
Field extended(const Grid& grid, const Nodes& nodes, double rest) {
    Field t = nodes.temperature;
    std::vector<char> known(grid.size);
    for (std::int64_t i = 0; i < grid.size; ++i)
        known[i] = nodes.temperature[i] != 0.0;
    for (int layer = 0; layer < extended_layers; ++layer) {
        const std::vector<char> before = known;
        const Field t_before = t;
#pragma omp parallel for schedule(static)
        for (std::int64_t k = 0; k <= grid.cells[2]; ++k)
            for (std::int64_t j = 0; j <= grid.cells[1]; ++j)
                for (std::int64_t i = 0; i <= grid.cells[0]; ++i) {
                    const std::int64_t at = grid.index(i, j, k);
                    if (before[at])
                        continue;
                    double sum = 0.0;
                    int count = 0;
                    for (int dk = -1; dk <= 1; ++dk)
                        for (int dj = -1; dj <= 1; ++dj)
                            for (int di = -1; di <= 1; ++di) {
                                const std::int64_t from = at + di + dj * grid.stride_y + dk * grid.stride_z;
                                if (before[from]) {
                                    sum += t_before[from];
                                    ++count;
                                }
                            }
                    if (count > 0) {
                        t[at] = sum / count;
                        known[at] = 1;
                    }
                }
    }
    for (std::int64_t i = 0; i < grid.size; ++i)
        if (!known[i])
            t[i] = rest;
    mirror_ghosts(grid, Boundary{}, t);
    // Beyond a fixed face the odd continuation, which mirror_ghosts has just overwritten, is the right one.
    return t;
}

/// The interpolated field's value at the nodes: weights 1/8, 3/4, 1/8 along each axis.
Field values_at_nodes(const Grid& grid, Field coefficients) {
    for (const std::int64_t stride : {std::int64_t(1), grid.stride_y, grid.stride_z}) {
        const Field before = coefficients;
#pragma omp parallel for schedule(static)
        for (std::int64_t at = stride; at < grid.size - stride; ++at)
            coefficients[at] = 0.75 * before[at] + 0.125 * (before[at - stride] + before[at + stride]);
    }
    return coefficients;
}

/// Node values of the temperature over the whole box, and where a face fixes it, that.
std::vector<double> node_temperatures(const Simulation& s) {
    Field t = extended(s.grid, s.nodes, s.coldest_temperature);
    const Boundary& boundary = s.parameters.boundary;
    for (int f = 0; f < 6; ++f)
        if (boundary[f].fixes_temperature())
            for_each_face_node(s.grid, f, [&](std::int64_t ghost, std::int64_t face, std::int64_t mirror) {
                t[ghost] = 2.0 * t[face] - t[mirror];
            });
    return without_padding(s.grid, values_at_nodes(s.grid, std::move(t)));
}

/// The hottest point of the material, up to its surface: linear along the grid's edges, as the pool is
/// measured.
double hottest_inside(const NodeLattice& nodes, const std::vector<double>& phi,
                      const std::vector<double>& temperature) {
    const std::array<std::int64_t, 3> stride{1, nodes.count[0], nodes.count[0] * nodes.count[1]};
    double hottest = 0.0;
#pragma omp parallel for schedule(static) reduction(max : hottest)
    for (std::int64_t k = 0; k < nodes.count[2]; ++k)
        for (std::int64_t j = 0; j < nodes.count[1]; ++j)
            for (std::int64_t i = 0; i < nodes.count[0]; ++i) {
                const std::array<std::int64_t, 3> place{i, j, k};
                const std::int64_t at = i + j * stride[1] + k * stride[2];
                if (phi[at] <= 0.0)
                    hottest = std::max(hottest, temperature[at]);
                for (int axis = 0; axis < 3; ++axis) {
                    if (place[axis] + 1 == nodes.count[axis])
                        continue;
                    const std::int64_t next = at + stride[axis];
                    if ((phi[at] <= 0.0) == (phi[next] <= 0.0))
                        continue;
                    const double share = phi[at] / (phi[at] - phi[next]);
                    hottest = std::max(hottest, std::lerp(temperature[at], temperature[next], share));
                }
            }
    return hottest;
}

BeamSnapshot beam_snapshot(const Laser& laser, double time) {
    BeamSnapshot b;
    double power = 0.0;
    const BeamPosition beam = beam_now(laser, time, power);
    const PathCorners corners = corners_at(laser.path, time);
    b.name = laser.name;
    b.position = beam.position;
    b.beam_direction = laser.direction;
    b.scan_direction = beam.scan_direction;
    b.power = power;
    b.speed = beam.speed;
    b.spot_radius = laser.spot_radius;
    b.on = power > 0.0;
    b.path_done = corners.done;
    b.path_to_come = corners.to_come;
    return b;
}

bool wanted(ParticleSelection selection, double phi_hat, double liquid_fraction) {
    switch (selection) {
    case ParticleSelection::none:
        return false;
    case ParticleSelection::surface:
        return std::abs(phi_hat) <= surface_gate;
    case ParticleSelection::melt:
        return liquid_fraction > 0.0;
    case ParticleSelection::all:
        return true;
    }
    return false;
}

/// Fills the snapshot's particles and counts the molten ones. The particles keep their order, however many
/// threads choose among them.
void sample_particles(const Simulation& s, ParticleSelection selection, const Field& node_phi_hat,
                      Snapshot& snapshot) {
    const Particles& particles = s.particles;
    const Field temperature = particle_temperatures(s.grid, particles, s.nodes);
    const bool chooses = selection != ParticleSelection::none;
    const Field phi_hat = chooses ? interpolate_to_particles(s.grid, particles, node_phi_hat) : Field{};

    // Looked at where they lie in memory, taken in the order of their ids.
    const std::vector<LaneGroup>& groups = particles.layout.groups;
    std::vector<char> takes(chooses ? particles.layout.size() : 0);
    std::int64_t liquid_particles = 0;
#pragma omp parallel for schedule(static) reduction(+ : liquid_particles)
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const EquationOfState& eos = s.eos[groups[g].kind];
        const std::int64_t first = groups[g].first_slot * lane_count;
        for (std::int64_t at = first; at < first + groups[g].slots * lane_count; ++at) {
            const double fraction = eos.liquid_fraction(temperature[at]);
            liquid_particles += fraction >= 1.0 && particles.mass[at] > 0.0;
            if (chooses)
                takes[at] = wanted(selection, phi_hat[at], fraction);
        }
    }
    snapshot.liquid_particles = liquid_particles;

    std::vector<std::int64_t> taken;
    for (std::int64_t q = 0; chooses && q < particles.count(); ++q)
        if (takes[particles.layout.place[q]])
            taken.push_back(q);
    const std::int64_t count = std::int64_t(taken.size());
    ParticleSample& sample = snapshot.particles;
    sample.position.resize(3 * count);
    sample.temperature.resize(count);
    sample.specific_energy.resize(count);
    sample.liquid_fraction.resize(count);
    sample.phi_hat.resize(count);
    sample.id.resize(count);
    sample.material.resize(count);
#pragma omp parallel for schedule(static)
    for (std::int64_t n = 0; n < count; ++n) {
        const std::int64_t q = taken[n], at = particles.layout.place[q];
        for (int axis = 0; axis < 3; ++axis)
            sample.position[3 * n + axis] = particles.position[q][axis];
        sample.temperature[n] = temperature[at];
        sample.specific_energy[n] = particles.specific_energy[at];
        sample.liquid_fraction[n] = s.eos[particles.material[q]].liquid_fraction(temperature[at]);
        sample.phi_hat[n] = phi_hat[at];
        sample.id[n] = particles.id_of(q);
        sample.material[n] = particles.material[q];
    }
}

} // namespace

Snapshot take_snapshot(const Simulation& s, ParticleSelection particles) {
    Snapshot snapshot;
    snapshot.title = s.parameters.title;
    snapshot.time = s.time;
    snapshot.step = s.step;
    snapshot.dt = s.dt;
    snapshot.solidus = s.parameters.materials.front().solidus;
    snapshot.liquidus = s.parameters.materials.front().liquidus;
    const Index3 n = s.grid.cells + 1;
    snapshot.nodes = {s.grid.origin, s.grid.dx, {n[0], n[1], n[2]}};
    const auto share = [](std::vector<double> f) {
        return std::make_shared<const std::vector<double>>(std::move(f));
    };
    snapshot.phi = share(without_padding(s.grid, s.surface.phi));
    const Field phi_hat = regularized(s.grid, s.surface.phi, s.parameters.level_set);
    snapshot.phi_hat = share(without_padding(s.grid, phi_hat));
    snapshot.mass = share(without_padding(s.grid, node_masses(s)));
    snapshot.temperature = share(node_temperatures(s));
    snapshot.peak_temperature = hottest_inside(snapshot.nodes, *snapshot.phi, *snapshot.temperature);
    snapshot.absorbed_energy = s.ledger.absorbed;
    snapshot.lost_energy = s.ledger.lost() + s.ledger.missed;
    for (const Laser& laser : s.parameters.lasers)
        snapshot.beams.push_back(beam_snapshot(laser, s.time));
    measure_pools(s.parameters.isotherms, snapshot);
    sample_particles(s, particles, phi_hat, snapshot);
    return snapshot;
}

Probe probe(const Simulation& s, const Vec3& point) {
    const BinPlace bin = bin_place(s.grid, point);
    const std::array<BSpline<double>, 3> n{BSpline<double>(bin.offset[0]), BSpline<double>(bin.offset[1]),
                                           BSpline<double>(bin.offset[2])};
    double temperature = 0.0, weight = 0.0, phi = 0.0;
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i) {
                const std::int64_t at =
                    s.grid.index(bin.node[0] + i - 1, bin.node[1] + j - 1, bin.node[2] + k - 1);
                const double w = n[0].value[i] * n[1].value[j] * n[2].value[k];
                phi += w * s.surface.phi[at];
                if (s.nodes.temperature[at] != 0.0) {
                    temperature += w * s.nodes.temperature[at];
                    weight += w;
                }
            }
    return {weight > 0.0 ? temperature / weight : std::numeric_limits<double>::quiet_NaN(), phi};
}

} // namespace meltscope
