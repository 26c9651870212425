#include "meltscope/scenario/scenario.hpp"

#include <cmath>
#include <stdexcept>

namespace meltscope {

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
