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

const std::vector<std::string>& view_names() {
    static const std::vector<std::string> names{"overview", "section", "top", "pool", "dashboard"};
    return names;
}

const std::vector<std::string>& colormap_names() {
    static const std::vector<std::string> names{"inferno", "magma", "plasma", "viridis", "cividis"};
    return names;
}

} // namespace meltscope
