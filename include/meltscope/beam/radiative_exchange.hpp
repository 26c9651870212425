#pragma once

#include "meltscope/mpm/free_surface.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace meltscope {

/// How finely radiation between parts of the surface is followed.
struct ExchangeOptions {
    double patch_size = 4.0; ///< cells, edge of the blocks that gather surface elements to patches
    int rays = 8;            ///< an element
};

/// What the exchange factors cost.
struct ExchangeCost {
    double seconds = 0.0;     ///< to make them
    std::int64_t bytes = 0;   ///< held
    std::int64_t factors = 0; ///< exchange areas other than zero, both directions counted
    std::int64_t patches = 0;
    std::int64_t rays = 0;
    std::int64_t stray_rays =
        0; ///< that met material where no element is near; their patch sees itself instead
};

/// Grey diffuse exchange between parts of the free surface that see each other. Stands as long as the
/// geometry.
///
/// Elements in the same block of the grid, of the same material and with the same axis nearest to their
/// normals (six ways) make a patch, which emits their mean and receives evenly: this is the simplification
/// that keeps it affordable. From every element rays are traced on the signed distance to what they meet; a
/// ray that leaves the box meets the surroundings at the ambient temperature. The exchange areas G_ij = A_i
/// F_ij obey reciprocity G_ij = G_ji exactly and the sum rule sum_j G_ij + surroundings_i = A_i to round-off:
/// the rays' estimates from both ends are averaged, scaled to the sums that each row must have, and the small
/// rest is what a patch exchanges with itself.
struct RadiativeExchange {
    std::vector<std::int32_t> patch; ///< of each element

    std::vector<double> area;         ///< A_i, m^2, of each patch
    std::vector<double> emissivity;   ///< of each patch
    std::vector<double> surroundings; ///< m^2, A_i x share of the patch's radiation that leaves the box

    std::vector<std::int64_t> row_start; ///< of each patch, and the end
    std::vector<std::int32_t> column;    ///< patch j
    std::vector<double> exchange_area;   ///< G_ij, m^2

    int sweeps = 0; ///< at most, of the radiosity's Gauss-Seidel iteration; see reabsorbed_power
    ExchangeCost cost;
};

/// Makes the exchange factors. The directions are a fixed set a ray count, turned by a hash of the element's
/// index: the same on every run and for any number of threads. Throws std::invalid_argument for options that
/// make no sense or a material without an emissivity in (0, 1].
RadiativeExchange make_radiative_exchange(const Grid& grid, const FreeSurface& surface,
                                          const Particles& particles, const std::vector<Material>& materials,
                                          const ExchangeOptions& options);

/// Adds the power in W that each element absorbs of what other parts of the surface emit and reflect, beyond
/// what the surroundings at `ambient` (K) would send from there. Together with the plain loss emissivity
/// sigma (T^4 - T_amb^4) this is the net exchange; it is zero to round-off in a closed isothermal cavity and
/// where all is at ambient. `temperature`: K, of the elements. Returns the sum in W.
///
/// Radiosity beyond that at ambient: u_i = eps_i sigma (T_i^4 - T_amb^4) + (1 - eps_i) sum_j G_ij u_j / A_i,
/// by Gauss-Seidel sweeps in the patches' order from the black body's u, until the error is surely below 1e-3
/// of the largest u.
double reabsorbed_power(const RadiativeExchange& exchange, const SurfaceElements& elements,
                        std::span<const double> temperature, double ambient, std::span<double> power);

} // namespace meltscope
