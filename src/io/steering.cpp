#include "meltscope/io/steering.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string_view>

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
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PathCorner, position, lit)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ScanPath, start, start_time, segments, passed)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Laser, name, power, absorptivity, spot_radius, profile,
                                   super_gaussian_order, volume_depth, volume_width, direction, on, path)
// With defaults: checkpoints from before a setting was there lack it.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PhysicsOptions, affine_transfer, deposit_at_surface,
                                                diffuse_energy, blend_time, radiation, evaporation,
                                                reabsorption, convection, ambient, quiescent_tolerance)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LevelSetOptions, radius, epsilon)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TimeOptions, end, cfl, max_step)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Cadence, every, every_steps)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(OutputSchedule, output, picture, checkpoint, particles)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Steering, boundary, lasers, physics, level_set, time, schedule)

namespace {

/// What no scenario and no command can have led to.
class Judge {
  public:
    void require(bool holds, std::string_view key, std::string_view what) const {
        if (!holds)
            throw SteeringError(fmt::format("the saved steering cannot be used: {} must be {}", key, what));
    }
    void above_zero(double value, std::string_view key) const {
        require(value > 0.0 && std::isfinite(value), key, "above zero");
    }
    void not_negative(double value, std::string_view key) const {
        require(value >= 0.0 && std::isfinite(value), key, "zero or above");
    }
    void between(double value, double low, double high, std::string_view key) const {
        require(value >= low && value <= high, key, fmt::format("from {} to {}", low, high));
    }

    void judge(const FaceCondition& face) const {
        if (face.kind == FaceCondition::Kind::fixed_temperature ||
            face.kind == FaceCondition::Kind::convection)
            above_zero(face.temperature, "boundary.temperature");
        not_negative(face.coefficient, "boundary.coefficient");
        require(std::isfinite(face.flux), "boundary.flux", "a number");
    }
    void judge(const Laser& laser) const {
        not_negative(laser.power, "lasers.power");
        between(laser.absorptivity, 0.0, 1.0, "lasers.absorptivity");
        above_zero(laser.spot_radius, "lasers.spot_radius");
        above_zero(laser.super_gaussian_order, "lasers.super_gaussian_order");
        not_negative(laser.volume_depth, "lasers.volume_depth");
        not_negative(laser.volume_width, "lasers.volume_width");
        require(laser.profile != BeamProfile::volumetric || laser.volume_depth > 0.0, "lasers.volume_depth",
                "above zero for a volumetric beam");
        between(laser.direction.norm(), 1.0 - 1e-6, 1.0 + 1e-6, "the length of lasers.direction");
        check_path(laser.path);
        for (const PathCorner& corner : laser.path.passed)
            require(corner.position.allFinite(), "lasers.path.passed", "of numbers");
    }
    void judge(const PhysicsOptions& physics) const {
        if (physics.blend_time)
            above_zero(*physics.blend_time, "physics.blend_time");
        not_negative(physics.convection, "physics.convection");
        above_zero(physics.ambient, "physics.ambient");
    }
    void judge(const TimeOptions& time) const {
        above_zero(time.end, "time.end");
        above_zero(time.cfl, "time.cfl");
        between(time.cfl, 0.0, 1.0, "time.cfl");
        if (time.max_step)
            above_zero(*time.max_step, "time.max_step");
    }
    void judge(const Cadence& cadence) const {
        if (cadence.every)
            above_zero(*cadence.every, "schedule.every");
        require(cadence.every_steps.value_or(1) >= 1, "schedule.every_steps", "1 or more");
    }
    void judge(const Steering& steering) const {
        for (const FaceCondition& face : steering.boundary)
            judge(face);
        for (const Laser& laser : steering.lasers)
            judge(laser);
        judge(steering.physics);
        between(steering.physics.quiescent_tolerance, 0.0, highest_quiescent_tolerance,
                "physics.quiescent_tolerance");
        between(steering.level_set.radius, 0.5, 8.0, "level_set.radius");
        between(steering.level_set.epsilon, 0.01, 8.0, "level_set.epsilon");
        judge(steering.time);
        judge(steering.schedule.output);
        judge(steering.schedule.checkpoint);
        if (steering.schedule.picture)
            judge(*steering.schedule.picture);
    }
};

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
        const Steering steering = json::parse(text).get<Steering>();
        Judge{}.judge(steering);
        return steering;
    } catch (const json::exception& error) {
        throw SteeringError(fmt::format("the saved steering cannot be read: {}", error.what()));
    } catch (const PathError& error) {
        throw SteeringError(fmt::format("the saved steering cannot be used: {}", error.what()));
    }
}

Steering with_changes(const Steering& steered, const Steering& original, const Steering& changed) {
    return merged(json(steered), json(original), json(changed)).get<Steering>();
}

} // namespace meltscope
