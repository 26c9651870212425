#include "scenario_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

const std::vector<std::string> material_keys{"density",     "solidus",       "liquidus",
                                             "latent_heat", "conductivity",  "heat_capacity",
                                             "emissivity",  "boiling_point", "latent_heat_of_vaporization",
                                             "molar_mass",  "source"};

/// Lowest value of the polynomial over [low, high] and where it is.
std::pair<double, double> minimum(const Polynomial& polynomial, double low, double high) {
    double where = polynomial(low) <= polynomial(high) ? low : high;
    if (polynomial.a[2] > 0.0) {
        const double vertex = -polynomial.a[1] / (2.0 * polynomial.a[2]);
        if (vertex > low && vertex < high) {
            where = vertex;
        }
    }
    return {polynomial(where), where};
}

Polynomial read_polynomial(const Section& property, const std::string& phase, double low, double high) {
    const std::vector<double> given = property.numbers(phase, quantity::number, 1, 3);
    Polynomial polynomial;
    std::copy(given.begin(), given.end(), polynomial.a.begin());
    const auto [value, where] = minimum(polynomial, low, high);
    if (!(value > 0.0) || !std::isfinite(polynomial(high))) {
        property.fail(phase, fmt::format("must be positive from {:g} K to {:g} K, is {:g} at {:g} K", low,
                                         high, value, where));
    }
    return polynomial;
}

/// Each phase must make sense where it occurs within 200 to 4500 K: powder and solid up to the liquidus, the
/// liquid from the solidus on.
PhaseProperty read_property(const Section& section, const std::string& key, const Material& material) {
    section.require(key);
    const Section property = section.section(key, {"solid", "liquid", "powder"});
    const double low = std::min(200.0, material.solidus);
    const double high = std::max(4500.0, material.liquidus);
    PhaseProperty result;
    result.solid = read_polynomial(property, "solid", low, material.liquidus);
    result.liquid = read_polynomial(property, "liquid", material.solidus, high);
    if (property.has("powder")) {
        result.powder = read_polynomial(property, "powder", low, material.liquidus);
    }
    return result;
}

} // namespace

Material read_material_section(const Section& section, const std::string& name) {
    section.allow_only(material_keys);
    Material material;
    material.name = name;
    material.density = section.above("density", quantity::density, 0.0);
    material.solidus = section.above("solidus", quantity::temperature, 0.0, highest_temperature);
    material.liquidus = section.above("liquidus", quantity::temperature, 0.0, highest_temperature);
    if (material.solidus >= material.liquidus) {
        section.fail("liquidus",
                     fmt::format("must be above the solidus, {:g} K, is {:g} K (a pure substance needs a "
                                 "narrow range too, over which the latent heat is spread)",
                                 material.solidus, material.liquidus));
    }
    material.latent_heat = section.in_range("latent_heat", quantity::specific_energy, 0.0, no_limit);
    material.conductivity = read_property(section, "conductivity", material);
    material.heat_capacity = read_property(section, "heat_capacity", material);
    if (section.has("emissivity")) {
        material.emissivity = section.in_range("emissivity", quantity::number, 0.0, 1.0);
    }
    material.boiling_point =
        section.maybe_above("boiling_point", quantity::temperature, material.liquidus, highest_temperature);
    material.latent_heat_of_vaporization =
        section.maybe_above("latent_heat_of_vaporization", quantity::specific_energy, 0.0);
    // The heaviest element has 0.29 kg/mol; more means that g/mol were written without their unit.
    material.molar_mass = section.maybe_above("molar_mass", quantity::molar_mass, 0.0, 1.0);
    material.source = section.has("source") ? section.text("source") : "";
    return material;
}

Material read_material(const std::filesystem::path& file) {
    const ReadContext context{file.string(), file.parent_path()};
    const toml::table tree = parse_toml(read_text_file(file, context.name), context.name);
    return read_material_section(Section(context, tree, ""), file.stem().string());
}

} // namespace meltscope
