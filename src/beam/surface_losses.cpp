#include "meltscope/beam/surface_losses.hpp"

#include "meltscope/constants.hpp"
#include "meltscope/mpm/group_stencils.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

namespace meltscope {
namespace {

/// Evaporation is taken as linear in the temperature over a step where it cannot change its own flux by more
/// than a share of weak_evaporation, and where what else heats the element cannot change it by more than
/// weak_change.
constexpr double weak_evaporation = 0.01, weak_change = 0.1;

double required(const std::optional<double>& value, const Material& material, const char* key,
                const char* loss) {
    if (!value)
        throw std::invalid_argument(
            fmt::format("material '{}' lacks the key '{}', which {} needs", material.name, key, loss));
    if (!(*value > 0.0 && std::isfinite(*value)))
        throw std::invalid_argument(
            fmt::format("{} of material '{}' must be above zero, not {}", key, material.name, *value));
    return *value;
}

LossLaw make_loss_law(const Material& material, const LossOptions& options) {
    LossLaw law;
    law.ambient = options.ambient;
    law.convection = options.convection;
    if (options.radiation) {
        const double emissivity = required(material.emissivity, material, "emissivity", "radiation");
        if (emissivity > 1.0)
            throw std::invalid_argument(fmt::format("emissivity of material '{}' must be at most 1, not {}",
                                                    material.name, emissivity));
        law.radiation = emissivity * constants::stefan_boltzmann;
    }
    if (options.evaporation) {
        const char* loss = "evaporation";
        const double boiling_point = required(material.boiling_point, material, "boiling_point", loss);
        const double molar_mass = required(material.molar_mass, material, "molar_mass", loss);
        const double latent_heat =
            required(material.latent_heat_of_vaporization, material, "latent_heat_of_vaporization", loss);
        law.evaporation = latent_heat * 0.82 * constants::standard_atmosphere *
                          std::sqrt(molar_mass / (2.0 * constants::pi * constants::gas_constant));
        law.evaporation_temperature = latent_heat * molar_mass / constants::gas_constant;
        law.inverse_boiling_point = 1.0 / boiling_point;
        // exp[B (1/T_b - 1/T)] falls faster than 1/sqrt(T) rises.
        law.evaporation_onset =
            1.0 / (law.inverse_boiling_point - std::log(dropped_evaporation) / law.evaporation_temperature);
        law.evaporation_onset = std::max(law.evaporation_onset, options.ambient);
    }
    return law;
}

double evaporative_flux(const LossLaw& law, double temperature) {
    if (law.evaporation == 0.0 || temperature <= law.evaporation_onset)
        return 0.0;
    return law.evaporation *
           std::exp(law.evaporation_temperature * (law.inverse_boiling_point - 1.0 / temperature)) /
           std::sqrt(temperature);
}

/// s of the radiative flux s (T - T_amb), W/m^2/K.
double radiative_coefficient(const LossLaw& law, double temperature) {
    return law.radiation * (temperature * temperature + law.ambient * law.ambient) *
           (temperature + law.ambient);
}

/// T' of e(T') + r [s (T' - T_amb) + q_evaporation(T')] = target, r = a dt/M_s: Newton within a bracket.
double evaporating_temperature(const LossLaw& law, const EquationOfState& eos, double target, double r,
                               double s) {
    double high = eos.temperature(target); // without losses
    double low = law.ambient;
    double t = high;
    for (int iteration = 0; iteration < 100 && low < high; ++iteration) {
        const double evaporation = evaporative_flux(law, t);
        const double excess = eos.energy(t) + r * (s * (t - law.ambient) + evaporation) - target;
        (excess > 0.0 ? high : low) = t;
        const double slope =
            eos.heat_capacity(t) + r * (s + evaporation * (law.evaporation_temperature / t - 0.5) / t);
        double next = t - excess / slope;
        if (!(next >= low && next <= high))
            next = 0.5 * (low + high);
        if (std::abs(next - t) <= 1e-11 * t)
            return next;
        t = next;
    }
    return t;
}

/// What the elements of a lane group lose, J.
struct LostLanes {
    Lanes radiated{0.0}, convected{0.0}, evaporated{0.0};
};

/// element_loss of a whole lane group; only what is, or may become, hot enough to evaporate is worked out one
/// by one.
LostLanes losses_of(const LossLaw& law, const EquationOfState& eos, const Lanes& area, const Lanes& mass,
                    const Lanes& temperature, const Lanes& gain, double dt) {
    const Lanes radiative =
        law.radiation * (temperature * temperature + law.ambient * law.ambient) * (temperature + law.ambient);
    const Lanes s = radiative + law.convection;
    const Lanes c = eos.heat_capacity(temperature);
    const Lanes a_dt = area * dt;
    const Lanes r = a_dt / mass;
    const Lanes above_ambient = temperature - law.ambient;
    const Lanes excess = a_dt * (above_ambient + (gain - r * s * above_ambient) / (c + r * s));
    LostLanes lost{radiative * excess, law.convection * excess, Lanes(0.0)};
    if (law.evaporation == 0.0)
        return lost;
    const auto evaporates =
        temperature > law.evaporation_onset || gain > c * (law.evaporation_onset - temperature);
    if (none_of(evaporates))
        return lost;
    for (int lane = 0; lane < lane_count; ++lane)
        if (evaporates[lane]) {
            const LossEnergy e =
                element_loss(law, eos, area[lane], mass[lane], temperature[lane], gain[lane], dt);
            lost.radiated[lane] = e.radiated;
            lost.convected[lane] = e.convected;
            lost.evaporated[lane] = e.evaporated;
        }
    return lost;
}

const Field& inertia(const Nodes& nodes) {
    return nodes.inertia.empty() ? nodes.mass : nodes.inertia;
}

/// Specific energy in J/kg that each node near the surface is about to gain from what D_i holds already.
void find_gains(const Grid& grid, const Boundary& boundary, LossElements& loss, Nodes& nodes) {
    fold_ghosts(grid, boundary, AtFixedFaces::leave, nodes.increment);
    const Field& mass = inertia(nodes);
#pragma omp parallel for schedule(static)
    for (const std::int64_t i : loss.near)
        loss.gain[i] = mass[i] > 0.0 ? nodes.increment[i] / mass[i] : 0.0; // none: only sleeping particles
    mirror_ghosts(grid, boundary, loss.gain);
}

/// Nodes with mass among the 27 around each element's point.
std::vector<std::int64_t> nodes_within_reach(const Grid& grid, const SurfaceElements& elements,
                                             const Field& mass) {
    std::vector<char> reached(grid.size, 0);
    for (const LaneGroup& group : elements.layout.groups)
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < lane_count + 2; ++i)
                    reached[group.corner + i + j * grid.stride_y + k * grid.stride_z] = 1;
    std::vector<std::int64_t> nodes;
    for (std::int64_t i = 0; i < grid.size; ++i)
        if (reached[i] && mass[i] > 0.0)
            nodes.push_back(i);
    return nodes;
}

} // namespace

std::vector<LossLaw> make_loss_laws(const std::vector<Material>& materials, const LossOptions& options) {
    if (!(options.ambient >= 0.0 && std::isfinite(options.ambient)))
        throw std::invalid_argument(fmt::format("the ambient temperature must not be {} K", options.ambient));
    if (!(options.convection >= 0.0 && std::isfinite(options.convection)))
        throw std::invalid_argument(
            fmt::format("the coefficient of convection must not be {} W/m^2/K", options.convection));
    std::vector<LossLaw> laws;
    for (const Material& material : materials)
        laws.push_back(make_loss_law(material, options));
    return laws;
}

LossFlux loss_flux(const LossLaw& law, double temperature) {
    const double excess = temperature - law.ambient;
    return {radiative_coefficient(law, temperature) * excess, law.convection * excess,
            evaporative_flux(law, temperature)};
}

LossEnergy element_loss(const LossLaw& law, const EquationOfState& eos, double area, double mass,
                        double temperature, double gain, double dt) {
    const double a_dt = area * dt;
    const double radiative = radiative_coefficient(law, temperature);
    const double s = radiative + law.convection;
    const double c = eos.heat_capacity(temperature); // J/kg/K
    const double r = a_dt / mass;
    double evaporation = 0.0, evaporation_slope = 0.0; // W/m^2, W/m^2/K
    bool stiff = false;
    if (law.evaporation > 0.0) {
        const double to_onset = law.evaporation_onset - temperature;
        if (to_onset < 0.0) {
            const double relative_slope =
                (law.evaporation_temperature / temperature - 0.5) / temperature; // 1/K
            evaporation = evaporative_flux(law, temperature);
            evaporation_slope = evaporation * relative_slope;
            stiff = r * evaporation_slope > weak_evaporation * c ||
                    std::abs(gain) * relative_slope > weak_change * c;
        } else {
            stiff = gain > c * to_onset;
        }
    }
    if (!stiff) {
        // c (T' - T) = gain - r [s (T' - T_amb) + q_evaporation(T) + (T' - T) dq_evaporation/dT]
        const double above_ambient = temperature - law.ambient;
        const double change =
            (gain - r * (s * above_ambient + evaporation)) / (c + r * (s + evaporation_slope));
        const double excess = a_dt * (above_ambient + change);
        return {radiative * excess, law.convection * excess,
                a_dt * (evaporation + evaporation_slope * change)};
    }
    const double t = evaporating_temperature(law, eos, eos.energy(temperature) + gain, r, s);
    const double excess = a_dt * (t - law.ambient);
    return {radiative * excess, law.convection * excess, a_dt * evaporative_flux(law, t)};
}

LossElements make_loss_elements(const Grid& grid, const Boundary& boundary, const SurfaceElements& elements,
                                const Nodes& nodes) {
    LossElements loss;
    loss.near = nodes_within_reach(grid, elements, inertia(nodes));
    loss.gain.assign(grid.size, 0.0);

    // The gain of one joule a square metre.
    Nodes even;
    even.mass = inertia(nodes);
    even.increment.assign(grid.size, 0.0);
    deposit(grid, elements, elements.area, even);
    find_gains(grid, boundary, loss, even);
    std::vector<double> gain;
    interpolate_to_surface(grid, elements, loss.gain, gain);
    loss.area.assign(elements.layout.size(), 0.0);
    loss.mass.assign(elements.layout.size(), 1.0);
    for (std::int64_t s = 0; s < elements.count(); ++s) {
        loss.area[elements.layout.place[s]] = elements.area[s];
        loss.mass[elements.layout.place[s]] = elements.area[s] / gain[s];
    }
    return loss;
}

LossEnergy deposit_losses(const Grid& grid, const Boundary& boundary, std::span<const LossLaw> laws,
                          const std::vector<EquationOfState>& eos, const SurfaceElements& elements, double dt,
                          LossElements& loss, Nodes& nodes) {
    find_gains(grid, boundary, loss, nodes);
    const LaneLayout& layout = elements.layout;
    // A sum a block, then these in their order: the same for any number of threads.
    std::vector<LossEnergy> of_block(layout.blocks.size());
    for_each_block(layout, [&](const LaneBlock& block) {
        LostLanes sum;
        for (std::int64_t g = block.first_group; g < block.last_group; ++g) {
            if (!loss.awake.empty() && !loss.awake[g])
                continue;
            const LaneGroup& group = layout.groups[g];
            NodeSums at_nodes;
            for (std::int64_t slot = group.first_slot; slot < group.first_slot + group.slots; ++slot) {
                const std::int64_t at = slot * lane_count;
                const PointStencil stencil = point_stencil(elements.offset_x.data(), elements.offset_y.data(),
                                                           elements.offset_z.data(), slot);
                const Lanes weight = load(&elements.normalization[at]);
                std::array<Lanes, 1> temperature, gain;
                stencil.gather(&nodes.temperature[group.corner], grid.stride_y, grid.stride_z, temperature);
                stencil.gather(&loss.gain[group.corner], grid.stride_y, grid.stride_z, gain);
                const LostLanes lost =
                    losses_of(laws[group.kind], eos[group.kind], load(&loss.area[at]), load(&loss.mass[at]),
                              weight * temperature[0], weight * gain[0], dt);
                stencil.scatter_value({-weight * (lost.radiated + lost.convected + lost.evaporated)},
                                      at_nodes);
                sum.radiated += lost.radiated;
                sum.convected += lost.convected;
                sum.evaporated += lost.evaporated;
            }
            at_nodes.add_to(nodes.increment.data(), group.corner, grid.stride_y, grid.stride_z);
        }
        of_block[&block - layout.blocks.data()] = {reduce(sum.radiated), reduce(sum.convected),
                                                   reduce(sum.evaporated)};
    });
    LossEnergy total;
    for (const LossEnergy& e : of_block) {
        total.radiated += e.radiated;
        total.convected += e.convected;
        total.evaporated += e.evaporated;
    }
    return total;
}

} // namespace meltscope
