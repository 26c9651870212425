#include "meltscope/scenario/scenario_file.hpp"

#include "scenario_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <type_traits>

namespace meltscope {
namespace {

/// The shortest decimal that reads back as the same double; always a TOML float, so that -0 keeps its sign.
std::string real(double value) {
    std::string text = fmt::format("{}", value);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            result += '\\';
            result += c;
        } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
            result += fmt::format("\\u{:04x}", static_cast<int>(c));
        } else {
            result += c;
        }
    }
    return result + "\"";
}

std::string list(const std::vector<double>& values) {
    std::vector<std::string> texts;
    for (const double value : values) {
        texts.push_back(real(value));
    }
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string point(const Vec3& v) {
    return list({v[0], v[1], v[2]});
}

/// Builds the text line by line.
struct Writer {
    std::string text;

    void header(const std::string& name) { text += fmt::format("\n{}\n", name); }
    void raw(const char* key, const std::string& value) { text += fmt::format("{} = {}\n", key, value); }
    void put(const char* key, double value) { raw(key, real(value)); }
    void put(const char* key, const Vec3& value) { raw(key, point(value)); }
    void put(const char* key, const std::string& value) { raw(key, quoted(value)); }
    void put(const char* key, const char* value) { raw(key, quoted(value)); }
    template <class T>
    requires std::is_integral_v<T>
    void put(const char* key, T value) { raw(key, fmt::format("{}", value)); }
    template <class T>
    void put(const char* key, const std::optional<T>& value) {
        if (value) {
            put(key, *value);
        }
    }
};

std::string polynomials(const PhaseProperty& property) {
    const auto one = [](const Polynomial& p) { return list(std::vector(p.a.begin(), p.a.end())); };
    const std::string powder = property.powder ? ", powder = " + one(*property.powder) : "";
    return fmt::format("{{solid = {}, liquid = {}{}}}", one(property.solid), one(property.liquid), powder);
}

void write_material(Writer& writer, const Material& material) {
    writer.header(fmt::format("[material.{}]", quoted(material.name)));
    writer.put("density", material.density);
    writer.put("solidus", material.solidus);
    writer.put("liquidus", material.liquidus);
    writer.put("latent_heat", material.latent_heat);
    writer.raw("conductivity", polynomials(material.conductivity));
    writer.raw("heat_capacity", polynomials(material.heat_capacity));
    writer.put("emissivity", material.emissivity);
    writer.put("boiling_point", material.boiling_point);
    writer.put("latent_heat_of_vaporization", material.latent_heat_of_vaporization);
    writer.put("molar_mass", material.molar_mass);
    writer.put("source", material.source);
}

struct ShapeWriter {
    Writer& writer;

    void operator()(const Box& box) const {
        writer.put("shape", "box");
        writer.put("min", box.min);
        writer.put("max", box.max);
    }
    void operator()(const Sphere& sphere) const {
        writer.put("shape", "sphere");
        writer.put("center", sphere.center);
        writer.put("radius", sphere.radius);
    }
    void operator()(const Cylinder& cylinder) const {
        writer.put("shape", "cylinder");
        writer.put("base", cylinder.base);
        writer.put("axis", cylinder.axis);
        writer.put("radius", cylinder.radius);
        writer.put("height", cylinder.height);
    }
    void operator()(const PowderSpec& powder) const {
        writer.put("shape", "powder");
        writer.put("min", powder.box.min);
        writer.put("max", powder.box.max);
        writer.put("d10", powder.d10);
        writer.put("d50", powder.d50);
        writer.put("d90", powder.d90);
        writer.put("percentiles", words::of(words::percentiles, powder.basis));
        writer.put("packing", powder.packing);
        writer.put("seed", powder.seed);
    }
    void operator()(const BallsSpec& balls) const {
        writer.put("shape", "balls");
        writer.put("file", balls.file.string());
    }
    void operator()(const StlSpec& stl) const {
        writer.put("shape", "stl");
        writer.put("file", stl.file.string());
        writer.put("scale", stl.scale);
    }
};

std::string face_text(const FaceSpec& face) {
    switch (face.kind) {
    case FaceSpec::Kind::temperature:
        return fmt::format("{{temperature = {}}}", real(face.temperature));
    case FaceSpec::Kind::convection:
        return fmt::format("{{convection = {}, ambient = {}}}", real(face.convection), real(face.ambient));
    case FaceSpec::Kind::flux:
        return fmt::format("{{flux = {}}}", real(face.flux));
    default:
        return "\"adiabatic\"";
    }
}

std::string segment_text(const PathSegment& segment) {
    const std::string power = segment.power ? ", power = " + real(*segment.power) : "";
    if (segment.kind == PathSegment::Kind::line) {
        return fmt::format("{{{} = {}, speed = {}{}}}", segment.laser_on ? "to" : "move", point(segment.end),
                           real(segment.speed), power);
    }
    if (segment.duration == 0.0 && !segment.laser_on) {
        return fmt::format("{{move = {}{}}}", point(segment.end), power);
    }
    return fmt::format("{{dwell = {}, at = {}{}{}}}", real(segment.duration), point(segment.end), power,
                       segment.laser_on ? "" : ", on = false");
}

void write_laser(Writer& writer, const Laser& laser) {
    writer.header("[[laser]]");
    writer.put("name", laser.name);
    writer.put("power", laser.power);
    writer.put("absorptivity", laser.absorptivity);
    writer.put("spot_radius", laser.spot_radius);
    writer.put("profile", words::of(words::profile, laser.profile));
    if (laser.profile == BeamProfile::super_gaussian) {
        writer.put("super_gaussian_order", laser.super_gaussian_order);
    }
    if (laser.profile == BeamProfile::volumetric) {
        writer.put("volume_depth", laser.volume_depth);
    }
    writer.put("direction", laser.direction);
    writer.put("on", laser.on);
    writer.put("start_time", laser.path.start_time);
    std::string path = fmt::format("[\n  {{move = {}}},\n", point(laser.path.start));
    for (const PathSegment& segment : laser.path.segments) {
        path += fmt::format("  {},\n", segment_text(segment));
    }
    writer.raw("path", path + "]");
}

void write_layer(Writer& writer, const ScheduledLayer& scheduled, const std::string& material) {
    const PowderLayer& layer = scheduled.layer;
    writer.header("[[layer]]");
    writer.put("time", scheduled.time);
    writer.put("thickness", layer.thickness);
    writer.put("material", material);
    writer.put("temperature", layer.temperature);
    if (layer.homogenised) {
        writer.put("state", "powder");
    } else {
        writer.put("d10", layer.d10);
        writer.put("d50", layer.d50);
        writer.put("d90", layer.d90);
        writer.put("percentiles", words::of(words::percentiles, layer.basis));
        writer.put("seed", layer.seed);
    }
    writer.put("packing", layer.packing);
}

void write_domain(Writer& writer, const DomainSpec& domain) {
    writer.header("[domain]");
    writer.put("min", domain.min);
    writer.put("max", domain.max);
    writer.put("cell_size", domain.cell_size);
    writer.put("particles_per_cell", domain.particles_per_cell);
}

void write_physics(Writer& writer, const PhysicsSpec& physics) {
    writer.header("[physics]");
    writer.put("diffusion", words::of(words::diffusion, physics.diffusion));
    writer.put("transfer", words::of(words::transfer, physics.transfer));
    writer.put("deposit", words::of(words::deposit, physics.deposit));
    writer.put("blend_time", physics.blend_time);
    writer.put("radiation", physics.radiation);
    writer.put("evaporation", physics.evaporation);
    writer.put("reabsorption", physics.reabsorption);
    writer.put("convection", physics.convection);
    writer.put("ambient", physics.ambient);
    writer.put("quiescent_tolerance", physics.quiescent_tolerance);
}

void write_output(Writer& writer, const OutputSpec& output) {
    writer.header("[output]");
    writer.put("every", output.every);
    writer.put("every_steps", output.every_steps);
    writer.put("particles", words::of(words::particles, output.particles));
    writer.put("particles_format", words::of(words::particles_format, output.particles_format));
    writer.put("surface", output.surface);
    writer.put("pool", output.pool);
    writer.put("grid", output.grid);
    writer.put("solidification", output.solidification);
    writer.put("compression", words::of(words::compression, output.compression));
    writer.put("precision", words::of(words::precision, output.precision));
    writer.raw("isotherms", list(output.isotherms));
    writer.put("pool_rows", words::of(words::pool_rows, output.pool_rows));
}

void write_render(Writer& writer, const RenderSpec& render) {
    writer.header("[render]");
    writer.put("every", render.every);
    writer.raw("size", fmt::format("[{}, {}]", render.size[0], render.size[1]));
    std::vector<std::string> views;
    for (const std::string& view : render.views) {
        views.push_back(quoted(view));
    }
    writer.raw("views", fmt::format("[{}]", fmt::join(views, ", ")));
    if (render.color_range) {
        writer.raw("color_range", list(std::vector(render.color_range->begin(), render.color_range->end())));
    }
    writer.put("colormap", render.colormap);
    writer.put("on_backlog", words::of(words::on_backlog, render.on_backlog));
    writer.put("background", words::of(words::background, render.background));
}

} // namespace

std::string to_toml(const Scenario& scenario) {
    Writer writer;
    writer.put("title", scenario.title);
    write_domain(writer, scenario.domain);
    for (const Material& material : scenario.materials) {
        write_material(writer, material);
    }
    for (const BodySpec& body : scenario.bodies) {
        writer.header("[[body]]");
        std::visit(ShapeWriter{writer}, body.shape);
        writer.put("material", body.material);
        writer.put("temperature", body.temperature);
        if (body.powder_packing) {
            writer.put("state", "powder");
            writer.put("packing", *body.powder_packing);
        }
    }
    writer.header("[boundary]");
    for (std::size_t i = 0; i < scenario.boundary.size(); ++i) {
        writer.raw(face_names[i], face_text(scenario.boundary[i]));
    }
    for (const Laser& laser : scenario.lasers) {
        write_laser(writer, laser);
    }
    for (const ScheduledLayer& scheduled : scenario.layers) {
        write_layer(writer, scheduled, scenario.materials[scheduled.layer.material].name);
    }
    write_physics(writer, scenario.physics);
    writer.header("[level_set]");
    writer.put("radius", scenario.level_set.radius);
    writer.put("epsilon", scenario.level_set.epsilon);
    writer.header("[time]");
    writer.put("end", scenario.time.end);
    writer.put("cfl", scenario.time.cfl);
    writer.put("max_step", scenario.time.max_step);
    write_output(writer, scenario.output);
    write_render(writer, scenario.render);
    writer.header("[checkpoint]");
    writer.put("every", scenario.checkpoint.every);
    writer.put("keep", scenario.checkpoint.keep);
    return writer.text;
}

} // namespace meltscope
