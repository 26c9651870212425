#include "reference/driver.hpp"
#include "reference/table.hpp"

#include "meltscope/beam/surface_losses.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

Material steel() {
    Material material = constant_material(25.0, 8000.0, 600.0);
    material.name = "316L";
    material.boiling_point = 3068.0;
    material.latent_heat_of_vaporization = 7.45e6;
    material.molar_mass = 0.0558;
    return material;
}

/// W/m^2 that a plate at `temperature` loses in a step too short to change it.
double flux_from_a_plate(double temperature) {
    const double dx = 10e-6, dt = 1e-13;
    const Grid grid = make_grid(Vec3::Zero(), dx, {8, 8, 10});
    const std::vector<EquationOfState> eos{make_equation_of_state(steel())};
    ParticleList list = lattice_points(grid, 2, [&](const Vec3& x) { return x[2] < 6.0 * dx; });
    set_state(
        eos, [&](const Vec3&) { return temperature; }, list);
    ThermalRun run(grid, eos, Boundary{}, std::move(list), 2);
    const FreeSurface surface = find_free_surface(grid, run.particles, run.nodes, {}, true);
    LossOptions options;
    options.evaporation = true;
    LossElements loss = make_loss_elements(grid, run.boundary, surface.elements, run.nodes);
    const LossEnergy lost = deposit_losses(grid, run.boundary, make_loss_laws({steel()}, options), eos,
                                           surface.elements, dt, loss, run.nodes);
    return lost.evaporated / (64.0 * dx * dx * dt);
}

TEST(EvaporationRate, a_plate_of_316L_loses_what_the_table_says) {
    ResultTable table("evaporation_rate", "temperature_K,reference_W_per_m2,computed_W_per_m2");
    std::ifstream in(MELTSCOPE_SOURCE_DIR "/tests/verification/evaporation_rate/reference.csv");
    std::string line;
    std::getline(in, line); // header
    int rows = 0;
    while (std::getline(in, line)) {
        const double temperature = std::stod(line.substr(0, line.find(',')));
        const double reference = std::stod(line.substr(line.rfind(',') + 1));
        const double computed = flux_from_a_plate(temperature);
        EXPECT_NEAR(computed, reference, 0.002 * reference) << temperature << " K";
        table.row({temperature, reference, computed});
        ++rows;
    }
    EXPECT_EQ(rows, 9);
}

} // namespace
} // namespace meltscope::verification
