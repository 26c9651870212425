#include "meltscope/scenario/setup.hpp"

#include "meltscope/build/ball_file.hpp"
#include "meltscope/build/fill.hpp"
#include "meltscope/build/powder.hpp"
#include "meltscope/build/stl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace meltscope {
namespace {

FaceCondition face_condition(const FaceSpec& spec) {
    FaceCondition face;
    switch (spec.kind) {
    case FaceSpec::Kind::adiabatic:
        face.kind = FaceCondition::Kind::adiabatic;
        break;
    case FaceSpec::Kind::temperature:
        face.kind = FaceCondition::Kind::fixed_temperature;
        face.temperature = spec.temperature;
        break;
    case FaceSpec::Kind::convection:
        face.kind = FaceCondition::Kind::convection;
        face.temperature = spec.ambient;
        face.coefficient = spec.convection;
        break;
    case FaceSpec::Kind::flux:
        face.kind = FaceCondition::Kind::fixed_flux;
        face.flux = spec.flux;
        break;
    }
    return face;
}

/// Distance to a shape, negative inside, for powder to settle on; exact for spheres, close elsewhere.
double distance_to(const Shape& shape, const Vec3& point) {
    if (const auto* sphere = std::get_if<Sphere>(&shape))
        return (point - sphere->center).norm() - sphere->radius;
    if (const auto* balls = std::get_if<Balls>(&shape)) {
        double nearest = 1e300;
        for (const Ball& ball : balls->balls)
            nearest = std::min(nearest, (point - ball.center).norm() - ball.radius);
        return nearest;
    }
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
        const Vec3 axis = cylinder->axis.normalized();
        const double along = (point - cylinder->base).dot(axis);
        const double radial = (point - cylinder->base - along * axis).norm() - cylinder->radius;
        const double ends = std::max(-along, along - cylinder->height);
        return std::min(std::max(radial, ends), 0.0) + std::hypot(std::max(radial, 0.0), std::max(ends, 0.0));
    }
    const Box box = bounding_box(shape); // solids: their bounding box
    const Vec3 outside = (box.min - point).cwiseMax(point - box.max);
    return std::min(outside.maxCoeff(), 0.0) + outside.cwiseMax(0.0).norm();
}

/// Refuses a body that has no part in the run.
void require_sites_for_all(const Scenario& scenario, const LatticeFill& filling, const Lattice& lattice) {
    std::vector<char> present(scenario.bodies.size(), 0);
#pragma omp parallel
    {
        std::vector<std::int16_t> sites(lattice.count[0] * lattice.count[1]);
        std::vector<char> seen(present.size(), 0);
#pragma omp for schedule(dynamic)
        for (std::int64_t k = 0; k < lattice.count[2]; ++k) {
            filling.layer(k, sites);
            for (const std::int16_t body : sites)
                if (body >= 0)
                    seen[body] = 1;
        }
#pragma omp critical
        for (std::size_t body = 0; body < present.size(); ++body)
            present[body] |= seen[body];
    }
    for (std::size_t body = 0; body < present.size(); ++body)
        if (!present[body])
            throw GeometryError(fmt::format(
                "body[{}] holds not one particle: it lies outside the domain, between the particles' "
                "sites, which are {:g} m apart, or wholly within bodies that come after it",
                body, lattice.spacing));
}

} // namespace

RunParameters run_parameters(const Scenario& scenario) {
    RunParameters p;
    p.title = scenario.title;
    p.materials = scenario.materials;
    for (int f = 0; f < 6; ++f)
        p.boundary[f] = face_condition(scenario.boundary[f]);
    p.lasers = scenario.lasers;
    p.physics.affine_transfer = scenario.physics.transfer == PhysicsSpec::Transfer::affine;
    p.physics.deposit_at_surface = scenario.physics.deposit == PhysicsSpec::Deposit::surface;
    p.physics.diffuse_energy = scenario.physics.diffusion == PhysicsSpec::Diffusion::energy;
    p.physics.blend_time = scenario.physics.blend_time;
    p.physics.radiation = scenario.physics.radiation;
    p.physics.evaporation = scenario.physics.evaporation;
    p.physics.reabsorption = scenario.physics.reabsorption;
    p.physics.convection = scenario.physics.convection;
    p.physics.ambient = scenario.physics.ambient;
    p.physics.quiescent_tolerance = scenario.physics.quiescent_tolerance;
    p.level_set = {scenario.level_set.radius, scenario.level_set.epsilon};
    p.time = {scenario.time.end, scenario.time.cfl, scenario.time.max_step};
    p.isotherms = scenario.output.isotherms;
    return p;
}

Grid scenario_grid(const Scenario& scenario) {
    return make_grid(scenario.domain.min, scenario.domain.cell_size, scenario.domain.cells());
}

int lattice_of(const Scenario& scenario) {
    return int(std::lround(std::cbrt(double(scenario.domain.particles_per_cell))));
}

std::vector<Shape> make_shapes(const Scenario& scenario) {
    const Box domain{scenario.domain.min, scenario.domain.max};
    std::vector<Shape> shapes;
    for (const BodySpec& body : scenario.bodies) {
        const auto make = [&](const auto& spec) -> Shape {
            using Spec = std::decay_t<decltype(spec)>;
            if constexpr (std::is_same_v<Spec, BallsSpec>) {
                return Balls{read_ball_file(spec.file, domain)};
            } else if constexpr (std::is_same_v<Spec, StlSpec>) {
                return read_stl(spec.file, spec.scale);
            } else if constexpr (std::is_same_v<Spec, PowderSpec>) {
                PowderGround ground;
                if (!shapes.empty())
                    ground.distance = [&shapes](const Vec3& point) {
                        double nearest = 1e300;
                        for (const Shape& shape : shapes)
                            nearest = std::min(nearest, distance_to(shape, point));
                        return nearest;
                    };
                return Balls{pack_powder(spec, ground)};
            } else {
                return spec;
            }
        };
        try {
            shapes.push_back(std::visit(make, body.shape));
        } catch (const GeometryError& error) {
            throw GeometryError(fmt::format("body[{}]: {}", shapes.size(), error.what()));
        }
    }
    return shapes;
}

ParticleList fill_scenario(const Scenario& scenario) {
    return fill_scenario(scenario, make_shapes(scenario));
}

ParticleList fill_scenario(const Scenario& scenario, std::span<const Shape> shapes) {
    const int n = lattice_of(scenario);
    const double spacing = scenario.domain.cell_size / n;
    Lattice lattice;
    lattice.origin = scenario.domain.min + Vec3::Constant(0.5 * spacing);
    lattice.spacing = spacing;
    lattice.count = scenario.domain.cells() * n;
    const std::int64_t layers = lattice.count[2], sites_in_layer = lattice.count[0] * lattice.count[1];

    struct Content { // of a body's sites
        std::int16_t material;
        double mass, energy;
        char powder;
    };
    const double volume = spacing * spacing * spacing;
    std::vector<Content> contents;
    bool has_powder = false;
    for (const BodySpec& body : scenario.bodies) {
        const std::size_t index = material_index(scenario, body.material);
        const Material& material = scenario.materials[index];
        contents.push_back({std::int16_t(index),
                            volume * material.density * body.powder_packing.value_or(1.0),
                            make_equation_of_state(material).energy(body.temperature),
                            char(body.powder_packing.has_value())});
        has_powder = has_powder || body.powder_packing;
    }

    // The layers' particles are counted first: so all arrays are made once, and all threads may fill them.
    const LatticeFill filling(shapes, lattice);
    require_sites_for_all(scenario, filling, lattice);
    std::vector<std::int64_t> start(layers + 1, 0);
#pragma omp parallel
    {
        std::vector<std::int16_t> sites(sites_in_layer);
#pragma omp for schedule(dynamic)
        for (std::int64_t k = 0; k < layers; ++k) {
            filling.layer(k, sites);
            start[k + 1] =
                std::count_if(sites.begin(), sites.end(), [](std::int16_t body) { return body >= 0; });
        }
    }
    std::partial_sum(start.begin(), start.end(), start.begin());

    ParticleList list;
    const std::int64_t count = start[layers];
    list.position.resize(count);
    list.mass.resize(count);
    list.volume.assign(count, volume);
    list.specific_energy.resize(count);
    list.id.resize(count);
    list.material.resize(count);
    list.powder.resize(has_powder ? count : 0);
#pragma omp parallel
    {
        std::vector<std::int16_t> sites(sites_in_layer);
#pragma omp for schedule(dynamic)
        for (std::int64_t k = 0; k < layers; ++k) {
            filling.layer(k, sites);
            std::int64_t q = start[k];
            for (std::int64_t j = 0; j < lattice.count[1]; ++j)
                for (std::int64_t i = 0; i < lattice.count[0]; ++i) {
                    const std::int16_t body = sites[i + lattice.count[0] * j];
                    if (body < 0)
                        continue;
                    const Content& content = contents[body];
                    list.position[q] = lattice.origin + spacing * Vec3(double(i), double(j), double(k));
                    list.mass[q] = content.mass;
                    list.specific_energy[q] = content.energy;
                    list.id[q] = q;
                    list.material[q] = content.material;
                    if (has_powder)
                        list.powder[q] = content.powder;
                    ++q;
                }
        }
    }
    return list;
}

Estimate estimate(const Scenario& scenario) {
    Estimate e;
    const Grid grid = scenario_grid(scenario);
    e.nodes = grid.node_count();
    const int n = lattice_of(scenario);
    const double site = std::pow(scenario.domain.cell_size / n, 3);
    double volume = 0.0;
    for (const BodySpec& body : scenario.bodies) {
        Box box{scenario.domain.min, scenario.domain.max};
        std::visit(
            [&](const auto& spec) {
                using Spec = std::decay_t<decltype(spec)>;
                if constexpr (std::is_same_v<Spec, PowderSpec>)
                    box = spec.box;
                else if constexpr (!std::is_same_v<Spec, BallsSpec> && !std::is_same_v<Spec, StlSpec>)
                    box = bounding_box(spec);
            },
            body.shape);
        const Vec3 size =
            (box.max.cwiseMin(scenario.domain.max) - box.min.cwiseMax(scenario.domain.min)).cwiseMax(0.0);
        volume += size.prod();
    }
    const Vec3 domain = scenario.domain.max - scenario.domain.min;
    for (const ScheduledLayer& scheduled : scenario.layers)
        volume += domain[0] * domain[1] * scheduled.layer.thickness;
    e.particles_at_most = std::int64_t(std::min(volume, domain.prod()) / site * (1.0 + 1e-9));
    // Measured: arrays of the step, the list they are made from, nodal fields and their temporaries.
    e.bytes = 140.0 * double(e.particles_at_most) + 200.0 * double(grid.size);
    return e;
}

} // namespace meltscope
