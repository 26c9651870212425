// Material files: read, then made into the tables that the solver uses.
#include "fuzz.hpp"

#include "meltscope/material/equation_of_state.hpp"
#include "meltscope/scenario/scenario_file.hpp"

#include <cmath>

using namespace meltscope;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Scratch scratch;
    const auto file = scratch.file("metal.toml", fuzz::text_of(data, size));
    Material material;
    if (!fuzz::is_taken<ScenarioError>([&] { material = read_material(file); }))
        return 0;
    fuzz::is_taken<std::invalid_argument>([&] {
        const EquationOfState state = make_equation_of_state(material);
        for (const double temperature : {300.0, material.solidus, material.liquidus, 4000.0})
            fuzz::require(!std::isnan(state.temperature(state.energy(temperature))), "T(e(T)) is no number");
        max_diffusivity(state, 300.0, 4000.0);
    });
    return 0;
}
