#pragma once

#include "meltscope/constants.hpp"
#include "meltscope/run/snapshot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

/// Snapshots without a solver: Rosenthal's moving source (with the singularity rounded off) on a plate of
/// IN625 with its top at z = 0, walls of the domain on the other five sides.
namespace meltscope::test {

struct SyntheticPlate {
    double spacing = 10e-6;                         // m
    std::array<std::int64_t, 3> count{201, 51, 29}; // nodes; four of them along z lie above the plate
    double ambient = 300.0;                         // K
    double roughness = 0.0;                         // m, height of waves on the surface
    bool with_particles = true;
    SharedField phi = nullptr; // kept over instants, as a run keeps it
};

inline double rosenthal(double ahead, double across, double depth, double speed, double absorbed,
                        double ambient) {
    constexpr double conductivity = 25.0;  // W/m/K
    constexpr double diffusivity = 5.0e-6; // m^2/s
    constexpr double rounding = 38e-6;     // m
    const double r = std::sqrt(ahead * ahead + across * across + depth * depth + rounding * rounding);
    return ambient + absorbed / (2.0 * constants::pi * conductivity * r) *
                         std::exp(-speed * (ahead + r) / (2.0 * diffusivity));
}

/// The plate at a time of a track along x that starts at x = 0.3 mm.
inline std::shared_ptr<Snapshot> make_snapshot(SyntheticPlate& plate, double time) {
    constexpr double speed = 0.8;   // m/s
    constexpr double power = 195.0; // W
    auto snapshot = std::make_shared<Snapshot>();
    snapshot->title = "IN625 bare plate, synthetic track";
    snapshot->time = time;
    snapshot->step = static_cast<std::int64_t>(time * 1e6);
    snapshot->dt = 1e-6;
    snapshot->solidus = 1563.0;
    snapshot->liquidus = 1623.0;
    NodeLattice& nodes = snapshot->nodes;
    nodes.spacing = plate.spacing;
    nodes.count = plate.count;
    nodes.origin = {0.0, -0.5 * plate.spacing * static_cast<double>(plate.count[1] - 1),
                    -plate.spacing * static_cast<double>(plate.count[2] - 5)};
    const auto total = static_cast<std::size_t>(plate.count[0] * plate.count[1] * plate.count[2]);
    const bool make_phi = !plate.phi;
    auto phi = std::make_shared<std::vector<double>>();
    auto phi_hat = std::make_shared<std::vector<double>>();
    auto mass = std::make_shared<std::vector<double>>();
    auto temperature = std::make_shared<std::vector<double>>();
    for (auto* field : {phi.get(), phi_hat.get(), mass.get(), temperature.get()}) {
        field->reserve(total);
    }
    const double laser_x = 0.3e-3 + speed * time;
    for (std::int64_t k = 0; k < plate.count[2]; ++k) {
        for (std::int64_t j = 0; j < plate.count[1]; ++j) {
            for (std::int64_t i = 0; i < plate.count[0]; ++i) {
                const Vec3 x =
                    nodes.origin + plate.spacing * Vec3(static_cast<double>(i), static_cast<double>(j),
                                                        static_cast<double>(k));
                const double waves = plate.roughness * std::sin(x.x() / 21e-6) * std::cos(x.y() / 17e-6);
                const double distance = x.z() - waves;
                phi->push_back(distance);
                phi_hat->push_back(0.5 * std::tanh(distance / plate.spacing));
                mass->push_back(distance < plate.spacing ? 8.44e-12 : 0.0);
                temperature->push_back(rosenthal(x.x() - laser_x, x.y(), std::min(x.z(), 0.0), speed,
                                                 0.38 * power, plate.ambient));
            }
        }
    }
    if (make_phi) {
        plate.phi = phi;
    }
    snapshot->phi = plate.phi;
    snapshot->phi_hat = phi_hat;
    snapshot->mass = mass;
    snapshot->temperature = temperature;
    snapshot->peak_temperature = *std::max_element(temperature->begin(), temperature->end());

    BeamSnapshot beam;
    beam.name = "laser";
    beam.position = {laser_x, 0.0, 0.0};
    beam.scan_direction = Vec3::UnitX();
    beam.power = power;
    beam.speed = speed;
    beam.spot_radius = 50e-6;
    beam.on = true;
    beam.path_done = {{{0.3e-3, 0.0, 0.0}}, {beam.position}};
    beam.path_to_come = {{beam.position}, {{1.7e-3, 0.0, 0.0}}};
    snapshot->beams.push_back(beam);
    // Grows as a real pool does at the start of a track.
    const double grown = 1.0 - std::exp(-time / 200e-6);
    snapshot->pools.push_back(
        {snapshot->liquidus, 372e-6 * grown, 141e-6 * grown, 68e-6 * grown, 1.6e-12 * grown});

    if (plate.with_particles) {
        std::int64_t id = 0;
        for (double x = 0.25e-3; x < 1.75e-3; x += 0.5 * plate.spacing) {
            for (double y = -0.1e-3; y < 0.1e-3; y += 0.5 * plate.spacing) {
                const double t = rosenthal(x - laser_x, y, 0.0, speed, 0.38 * power, plate.ambient);
                ParticleSample& sample = snapshot->particles;
                sample.position.insert(sample.position.end(), {x, y, -0.25 * plate.spacing});
                sample.temperature.push_back(t);
                sample.specific_energy.push_back(600.0 * t);
                sample.liquid_fraction.push_back(std::clamp((t - 1563.0) / 60.0, 0.0, 1.0));
                sample.phi_hat.push_back(-0.2);
                sample.id.push_back(id++);
                sample.material.push_back(0);
            }
        }
    }
    return snapshot;
}

} // namespace meltscope::test
