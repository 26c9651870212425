#pragma once

#include "meltscope/mpm/stencil.hpp"
#include "meltscope/mpm/thermal_step.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace meltscope::verification {

/// A material whose properties do not change with temperature and that stays solid below 5000 K.
inline Material constant_material(double conductivity = 1.0, double density = 1.0,
                                  double heat_capacity = 1.0) {
    Material m;
    m.name = "constant";
    m.density = density;
    m.solidus = 5000.0;
    m.liquidus = 5500.0;
    m.conductivity.solid = m.conductivity.liquid = {{conductivity, 0.0, 0.0}};
    m.heat_capacity.solid = m.heat_capacity.liquid = {{heat_capacity, 0.0, 0.0}};
    return m;
}

/// The points of a lattice of n x n x n points a cell that lie inside, each with its share of the volume, as
/// material 0. Masses and energies are still zero.
inline ParticleList lattice_points(const Grid& grid, int n, const std::function<bool(const Vec3&)>& inside) {
    ParticleList list;
    const double h = grid.dx / n; // m
    for (std::int64_t k = 0; k < grid.cells[2] * n; ++k)
        for (std::int64_t j = 0; j < grid.cells[1] * n; ++j)
            for (std::int64_t i = 0; i < grid.cells[0] * n; ++i) {
                const Vec3 x = grid.origin + h * Vec3(double(i) + 0.5, double(j) + 0.5, double(k) + 0.5);
                if (!inside(x))
                    continue;
                list.id.push_back(list.size());
                list.position.push_back(x);
                list.volume.push_back(h * h * h);
            }
    list.material.assign(list.position.size(), 0);
    list.mass.assign(list.position.size(), 0.0);
    list.specific_energy.assign(list.position.size(), 0.0);
    return list;
}

inline bool everywhere(const Vec3&) {
    return true;
}

/// Moves every point by up to `amplitude` (m) along each axis, always the same way, but not out of the box.
inline void jitter(const Grid& grid, double amplitude, ParticleList& list) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> shift(-amplitude, amplitude);
    for (Vec3& x : list.position) {
        const Vec3 moved = x + Vec3(shift(random), shift(random), shift(random));
        x = moved.cwiseMax(grid.origin).cwiseMin(grid.upper_corner());
    }
}

/// Masses by the density of each point's material, energies by the temperature in K at its place.
inline void set_state(const std::vector<EquationOfState>& materials,
                      const std::function<double(const Vec3&)>& temperature, ParticleList& list) {
    for (std::int64_t q = 0; q < list.size(); ++q) {
        const EquationOfState& eos = materials[list.material[q]];
        list.mass[q] = eos.density * list.volume[q];
        list.specific_energy[q] = eos.energy(temperature(list.position[q]));
    }
}

/// Value of a nodal field at a point, by the B-spline.
inline double interpolate(const Grid& grid, const Field& field, const Vec3& point) {
    const BinPlace bin = bin_place(grid, point);
    const BSpline<double> x(bin.offset[0]), y(bin.offset[1]), z(bin.offset[2]);
    double sum = 0.0;
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < 3; ++i)
                sum += x.value[i] * y.value[j] * z.value[k] *
                       field[grid.index(bin.node[0] + i - 1, bin.node[1] + j - 1, bin.node[2] + k - 1)];
    return sum;
}

/// How a verification run steps: dt = cfl dx^2/alpha and b = min(1, dt alpha/dx^2), unless b is given.
struct Stepping {
    double cfl = 0.5;
    bool affine = true;
    bool energy_gradient = false;
    double blend = -1.0; ///< below zero: tied to dt
    /// K, that losses can bring about; otherwise the coldest of the start and of the faces
    double ambient = 1e300;
};

/// The thermal step, driven directly: particles, nodes and the ledger of one run.
class ThermalRun {
  public:
    Grid grid;
    std::vector<EquationOfState> materials;
    Boundary boundary;
    StepOptions options;
    Particles particles;
    Nodes nodes;
    double time = 0.0;         ///< s
    double conducted = 0.0;    ///< J, through faces of fixed temperature
    double start_energy = 0.0; ///< J

    ThermalRun(Grid grid_, std::vector<EquationOfState> materials_, const Boundary& boundary_,
               ParticleList list, int lattice, const Stepping& stepping = {})
        : grid(grid_), materials(std::move(materials_)), boundary(boundary_),
          particles(make_particles(grid, std::move(list), lattice)),
          nodes(make_nodes(grid, particles, int(materials.size()), boundary)), stepping_(stepping) {
        options.affine = stepping.affine;
        options.energy_gradient = stepping.energy_gradient;
        start_energy = total_energy(particles);
        double least = std::min(stepping.ambient, coldest_particle());
        for (const FaceCondition& face : boundary)
            if (face.fixes_temperature())
                least = std::min(least, face.temperature);
        for (const EquationOfState& eos : materials)
            options.least_energy.push_back(eos.energy(std::max(0.0, least - 0.01)));
        particles_to_grid(grid, particles, nullptr, nodes);
        favre_mean(grid, materials, boundary, nodes);
        if (options.affine) {
            // At faces of fixed temperature the nodes' temperature is the face's, their energy is not.
            std::vector<Field> energy(materials.size(), Field(grid.size, 0.0));
            for (std::size_t a = 0; a < materials.size(); ++a)
                for (std::int64_t i = 0; i < grid.size; ++i)
                    energy[a][i] = materials[a].energy(nodes.temperature[i]);
            particles_to_grid(grid, particles, &energy, nodes);
            favre_mean(grid, materials, boundary, nodes);
        }
    }

    /// Steps through `duration` (s) in equal steps of about cfl dx^2/alpha. `source(dt)` adds to
    /// nodes.increment.
    template <class Source>
    void advance(double duration, double alpha, Source source) {
        const double cell_time = grid.dx * grid.dx / alpha;
        const auto steps = std::int64_t(std::ceil(duration / (stepping_.cfl * cell_time) - 1e-9));
        const double dt = duration / double(steps);
        options.blend = stepping_.blend >= 0.0 ? stepping_.blend : std::min(1.0, dt / cell_time);
        for (std::int64_t s = 0; s < steps; ++s) {
            diffuse(grid, particles, materials, options, dt, nodes);
            source(dt);
            conducted += update_grid_energy(grid, particles, materials, boundary, options, dt, nodes);
            grid_to_particles_to_grid(grid, options, particles, nodes);
            favre_mean(grid, materials, boundary, nodes);
            time += dt;
        }
    }

    void advance(double duration, double alpha) {
        advance(duration, alpha, [](double) {});
    }

    /// Temperature in K at a point, interpolated from the nodes.
    double temperature(const Vec3& point) const { return interpolate(grid, nodes.temperature, point); }

    /// Coldest particle by its own energy, in K.
    double coldest_particle() const {
        double coldest = 1e300;
        for (std::int64_t q = 0; q < particles.count(); ++q)
            coldest = std::min(coldest, own_temperature(q));
        return coldest;
    }

    double hottest_particle() const {
        double hottest = -1e300;
        for (std::int64_t q = 0; q < particles.count(); ++q)
            hottest = std::max(hottest, own_temperature(q));
        return hottest;
    }

    /// T(e_p) of particle q in K.
    double own_temperature(std::int64_t q) const {
        const EquationOfState& eos = materials[particles.material[q]];
        return eos.temperature(particles.specific_energy[particles.layout.place[q]]);
    }

    /// Largest difference in K between T(e_p) and the temperature that the nodes have at the particle.
    double spread() const {
        const Field at_nodes = particle_temperatures(grid, particles, nodes);
        double most = 0.0;
        for (std::int64_t q = 0; q < particles.count(); ++q)
            most = std::max(most, std::abs(own_temperature(q) - at_nodes[particles.layout.place[q]]));
        return most;
    }

  private:
    Stepping stepping_;
};

} // namespace meltscope::verification
