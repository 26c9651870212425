#include "meltscope/io/steering.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

// An optional value is null or the value; a vector its three components.
namespace nlohmann {
template <class T>
struct adl_serializer<std::optional<T>> {
    static void to_json(json& j, const std::optional<T>& value) { j = value ? json(*value) : json(nullptr); }
    static void from_json(const json& j, std::optional<T>& value) {
        value = j.is_null() ? std::nullopt : std::optional<T>(j.get<T>());
    }
};
template <>
struct adl_serializer<meltscope::Vec3> {
    static void to_json(json& j, const meltscope::Vec3& v) { j = std::array<double, 3>{v[0], v[1], v[2]}; }
    static void from_json(const json& j, meltscope::Vec3& v) {
        const auto a = j.get<std::array<double, 3>>();
        v = {a[0], a[1], a[2]};
    }
};
} // namespace nlohmann

namespace meltscope {

using nlohmann::json;

// clang-format off
NLOHMANN_JSON_SERIALIZE_ENUM(FaceCondition::Kind,
    {{FaceCondition::Kind::adiabatic, "adiabatic"}, {FaceCondition::Kind::fixed_temperature, "temperature"},
     {FaceCondition::Kind::convection, "convection"}, {FaceCondition::Kind::fixed_flux, "flux"}})
NLOHMANN_JSON_SERIALIZE_ENUM(BeamProfile,
    {{BeamProfile::gaussian, "gaussian"}, {BeamProfile::top_hat, "top_hat"},
     {BeamProfile::super_gaussian, "super_gaussian"}, {BeamProfile::volumetric, "volumetric"}})
NLOHMANN_JSON_SERIALIZE_ENUM(PathSegment::Kind,
    {{PathSegment::Kind::line, "line"}, {PathSegment::Kind::dwell, "dwell"}})
NLOHMANN_JSON_SERIALIZE_ENUM(ParticleSelection,
    {{ParticleSelection::none, "none"}, {ParticleSelection::surface, "surface"},
     {ParticleSelection::melt, "melt"}, {ParticleSelection::all, "all"}})
// clang-format on

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FaceCondition, kind, temperature, coefficient, flux)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PathSegment, kind, end, speed, duration, power, laser_on)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ScanPath, start, start_time, segments, passed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Laser, name, power, absorptivity, spot_radius, profile,
                                   super_gaussian_order, volume_depth, volume_width, direction, on, path)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PhysicsOptions, affine_transfer, deposit_at_surface, diffuse_energy,
                                   blend_time, radiation, evaporation, reabsorption, convection, ambient)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LevelSetOptions, radius, epsilon)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimeOptions, end, cfl, max_step)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Cadence, every, every_steps)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OutputSchedule, output, picture, checkpoint, particles)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Steering, boundary, lasers, physics, level_set, time, schedule)

namespace {

json merged(const json& steered, const json& original, const json& changed) {
    if (original == changed)
        return steered;
    if (steered.is_object() && original.is_object() && changed.is_object()) {
        json result = steered;
        for (const auto& [key, value] : changed.items())
            result[key] = merged(steered.at(key), original.at(key), value);
        return result;
    }
    const bool named = changed.is_array() && !changed.empty() && changed[0].contains("name");
    if (named && steered.size() == changed.size() && original.size() == changed.size()) {
        json result = json::array();
        for (std::size_t n = 0; n < changed.size(); ++n)
            result.push_back(merged(steered[n], original[n], changed[n]));
        return result;
    }
    return changed;
}

} // namespace

Steering steering_of(const RunParameters& parameters, const OutputSchedule& schedule) {
    return {parameters.boundary,  parameters.lasers, parameters.physics,
            parameters.level_set, parameters.time,   schedule};
}

void apply_steering(const Steering& steering, RunParameters& parameters, OutputSchedule& schedule) {
    parameters.boundary = steering.boundary;
    parameters.lasers = steering.lasers;
    parameters.physics = steering.physics;
    parameters.level_set = steering.level_set;
    parameters.time = steering.time;
    schedule = steering.schedule;
}

std::string steering_text(const Steering& steering) {
    return json(steering).dump(1);
}

Steering read_steering(const std::string& text) {
    try {
        return json::parse(text).get<Steering>();
    } catch (const json::exception& error) {
        throw SteeringError(fmt::format("the saved steering cannot be read: {}", error.what()));
    }
}

Steering with_changes(const Steering& steered, const Steering& original, const Steering& changed) {
    return merged(json(steered), json(original), json(changed)).get<Steering>();
}

} // namespace meltscope
