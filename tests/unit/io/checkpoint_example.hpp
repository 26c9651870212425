#pragma once

#include "meltscope/io/checkpoint.hpp"

#include <cmath>
#include <random>

namespace meltscope::testing {

/// A checkpoint of `count` particles with values that have no pattern, some of them awkward.
inline CheckpointData example_checkpoint(std::size_t count) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal;
    const auto values = [&](std::size_t size) {
        std::vector<double> result(size);
        for (auto& value : result)
            value = normal(random);
        return result;
    };
    CheckpointData data;
    data.time = 1.25e-3;
    data.step = 123456789012;
    data.dt = 0.1e-6;
    data.particles.position = values(3 * count);
    data.particles.mass = values(count);
    data.particles.volume = values(count);
    data.particles.specific_energy = values(count);
    for (std::size_t n = 0; n < count; ++n) {
        data.particles.id.push_back(static_cast<std::int64_t>(n) * 3000000000);
        data.particles.material.push_back(static_cast<std::int32_t>(n % 3));
    }
    if (count > 2)
        data.particles.specific_energy[1] = -0.0, data.particles.specific_energy[2] = std::nan("");
    data.particles.extra = {{"energy_gradient", values(3 * count)}, {"peak_temperature", values(count)}};
    data.grid = {{"phi", {3, 4, 5}, values(60)}, {"surface_weight", {7}, values(7)}};
    data.scenario = "title = \"Schwei\xc3\x9f"
                    "bad\"\n";
    data.steering = "{\"laser.power\": 195}";
    data.journal = "";
    data.ledger = {{"absorbed", 1.0 / 3.0}, {"residual", -1e-17}};
    return data;
}

} // namespace meltscope::testing
