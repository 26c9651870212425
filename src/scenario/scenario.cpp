#include "meltscope/scenario/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace meltscope {
namespace {

/// Cells across a Gaussian beam for these errors on a plate; see "Time to solution" in
/// tests/benchmarks/README.md.
constexpr double cells_for_three_percent = 10.0, cells_for_one_percent = 12.0;

bool is_used(const Scenario& scenario, std::size_t material) {
    return std::any_of(
               scenario.bodies.begin(), scenario.bodies.end(),
               [&](const BodySpec& body) { return body.material == scenario.materials[material].name; }) ||
           std::any_of(scenario.layers.begin(), scenario.layers.end(), [&](const ScheduledLayer& scheduled) {
               return std::size_t(scheduled.layer.material) == material;
           });
}

} // namespace

double DomainSpec::particle_spacing() const {
    return cell_size / std::round(std::cbrt(particles_per_cell));
}

std::size_t material_index(const Scenario& scenario, const std::string& name) {
    for (std::size_t i = 0; i < scenario.materials.size(); ++i) {
        if (scenario.materials[i].name == name) {
            return i;
        }
    }
    throw std::out_of_range("the scenario has no material called " + name);
}

std::vector<std::string> scenario_notes(const Scenario& scenario) {
    std::vector<std::string> notes;
    for (const Material& material : scenario.materials) {
        if (material.heat_capacity.powder) {
            notes.push_back(
                "material \"" + material.name +
                "\": heat_capacity.powder is not used; a kilogram of powder holds as much heat as a "
                "kilogram of the bulk, so that melting keeps the energy");
        }
    }
    for (std::size_t m = 0; m < scenario.materials.size(); ++m)
        if (!is_used(scenario, m))
            notes.push_back("material \"" + scenario.materials[m].name +
                            "\": no body and no layer is made of it");
    for (const Laser& laser : scenario.lasers) {
        if (const double end = path_end_time(laser.path); end > scenario.time.end)
            notes.push_back(
                fmt::format("laser \"{}\": its path ends at t = {:g} s, after time.end = {:g} s; the "
                            "rest is not run",
                            laser.name, end, scenario.time.end));
        const double width = 2.0 * laser.spot_radius, cells = width / scenario.domain.cell_size;
        if (cells < 0.999 * cells_for_three_percent)
            notes.push_back(fmt::format(
                "laser \"{}\": its beam (1/e^2 diameter {:g} um) is {:.3g} cells wide; temperatures err by "
                "some "
                "3 % of the peak with {:g} cells, 1 % with {:g}: a cell_size of {:.3g} or {:.3g} um",
                laser.name, 1e6 * width, cells, cells_for_three_percent, cells_for_one_percent,
                1e6 * width / cells_for_three_percent, 1e6 * width / cells_for_one_percent));
    }
    return notes;
}

const std::vector<std::string>& view_names() {
    static const std::vector<std::string> names{"overview", "section", "top", "pool", "dashboard"};
    return names;
}

const std::vector<std::string>& colormap_names() {
    static const std::vector<std::string> names{"inferno", "magma", "plasma", "viridis", "cividis"};
    return names;
}

} // namespace meltscope
