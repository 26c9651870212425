#include "parameter_parts.hpp"

#include "meltscope/scenario/scenario.hpp"

#include <fmt/format.h>

/// Parameters of the faces of the domain.
namespace meltscope {
namespace {

std::string shown_face(const FaceCondition& face) {
    switch (face.kind) {
    case FaceCondition::Kind::adiabatic:
        return "adiabatic";
    case FaceCondition::Kind::fixed_temperature:
        return fmt::format("temperature {}", shown(face.temperature, "K"));
    case FaceCondition::Kind::convection:
        return fmt::format("convection {} ambient {}", shown(face.coefficient, "W/m^2/K"),
                           shown(face.temperature, "K"));
    case FaceCondition::Kind::fixed_flux:
        break;
    }
    return fmt::format("flux {}", shown(face.flux, "W/m^2"));
}

std::string set_face(Run& run, int f, Arguments& arguments) {
    FaceCondition face;
    std::string text;
    const std::string kind =
        arguments.choice("the condition", {"adiabatic", "temperature", "convection", "flux"});
    if (kind == "temperature") {
        face.kind = FaceCondition::Kind::fixed_temperature;
        face.temperature = arguments.quantity("the temperature", quantity::temperature);
        require_positive(face.temperature, "the temperature", "K");
        text = fmt::format(" {} K", exact(face.temperature));
    } else if (kind == "convection") {
        face.kind = FaceCondition::Kind::convection;
        face.coefficient = arguments.quantity("the heat transfer coefficient",
                                              quantity::heat_transfer_coefficient, {"ambient"});
        require_between(face.coefficient, 0.0, infinite, "the heat transfer coefficient", "W/m^2/K");
        face.temperature = run.simulation.parameters.physics.ambient;
        if (arguments.take("ambient"))
            face.temperature = arguments.quantity("the ambient temperature", quantity::temperature);
        require_positive(face.temperature, "the ambient temperature", "K");
        text = fmt::format(" {} W/m^2/K ambient {} K", exact(face.coefficient), exact(face.temperature));
    } else if (kind == "flux") {
        face.kind = FaceCondition::Kind::fixed_flux;
        face.flux = arguments.quantity("the flux", quantity::heat_flux);
        text = fmt::format(" {} W/m^2", exact(face.flux));
    }
    run.simulation.parameters.boundary[std::size_t(f)] = face;
    return kind + text;
}

Parameter face_parameter(int f) {
    return {fmt::format("boundary.{}", face_names[std::size_t(f)]),
            "adiabatic, temperature T, convection H [ambient T] or flux Q",
            "What holds at this face of the domain.",
            {"adiabatic", "temperature", "convection", "flux"},
            [f](const ConsoleState&, const Run& run) {
                return shown_face(run.simulation.parameters.boundary[std::size_t(f)]);
            },
            [f](ConsoleState&, Run& run, Arguments& arguments) { return set_face(run, f, arguments); },
            update_boundary};
}

} // namespace

std::vector<Parameter> boundary_parameters() {
    std::vector<Parameter> faces;
    for (int f = 0; f < int(face_names.size()); ++f)
        faces.push_back(face_parameter(f));
    return faces;
}

} // namespace meltscope
