#include "scenario_parts.hpp"
#include "scenario_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meltscope {
namespace {

constexpr const char* axis_names = "xyz";
constexpr double most_cells_along_an_axis = 1 << 20; // indices of nodes stay far from overflow

/// Refuses boxes that are empty or turned inside out.
void check_box(const Section& section, const Vec3& min, const Vec3& max) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(max[axis] > min[axis])) {
            section.fail(
                "max",
                fmt::format("must be above min along each axis; along {} it is {:g} m and min is {:g} m",
                            axis_names[axis], max[axis], min[axis]));
        }
    }
}

void check_whole_cells(const Section& section, const DomainSpec& domain) {
    for (int axis = 0; axis < 3; ++axis) {
        const double length = domain.max[axis] - domain.min[axis];
        const double cells = length / domain.cell_size;
        if (!(cells <= most_cells_along_an_axis)) {
            section.fail("cell_size", fmt::format("gives {:g} cells along {}; at most {:.0f} are possible",
                                                  cells, axis_names[axis], most_cells_along_an_axis));
        }
        const double whole = std::max(1.0, std::round(cells));
        if (std::abs(cells - whole) > 1e-6) {
            section.fail("max",
                         fmt::format("the length along {}, {:g} m, is not a whole number of cells of {:g} m; "
                                     "the nearest that is: {:g} m ({:.0f} cell{})",
                                     axis_names[axis], length, domain.cell_size, whole * domain.cell_size,
                                     whole, whole == 1.0 ? "" : "s"));
        }
    }
}

[[noreturn]] void fail_outside(const Section& section, const DomainSpec& domain) {
    section.fail(fmt::format("lies wholly outside the domain, which reaches from [{:g}, {:g}, {:g}] to "
                             "[{:g}, {:g}, {:g}] m",
                             domain.min[0], domain.min[1], domain.min[2], domain.max[0], domain.max[1],
                             domain.max[2]));
}

/// Refuses what shares no volume with the domain; [min, max] bounds it.
void check_meets(const Section& section, const DomainSpec& domain, const Vec3& min, const Vec3& max) {
    if (!((max.array() > domain.min.array()).all() && (min.array() < domain.max.array()).all())) {
        fail_outside(section, domain);
    }
}

Box read_box(const Section& section, const DomainSpec& domain) {
    Box box{section.vector("min", quantity::length), section.vector("max", quantity::length)};
    check_box(section, box.min, box.max);
    check_meets(section, domain, box.min, box.max);
    return box;
}

Sphere read_sphere(const Section& section, const DomainSpec& domain) {
    Sphere sphere{section.vector("center", quantity::length), section.above("radius", quantity::length, 0.0)};
    const Vec3 nearest = sphere.center.cwiseMax(domain.min).cwiseMin(domain.max);
    if (!((nearest - sphere.center).norm() < sphere.radius)) {
        fail_outside(section, domain);
    }
    return sphere;
}

Cylinder read_cylinder(const Section& section, const DomainSpec& domain) {
    Cylinder cylinder;
    cylinder.base = section.vector("base", quantity::length);
    cylinder.axis = section.direction("axis", cylinder.axis);
    cylinder.radius = section.above("radius", quantity::length, 0.0);
    cylinder.height = section.above("height", quantity::length, 0.0);
    const Vec3 top = cylinder.base + cylinder.height * cylinder.axis;
    // A disc of radius R with normal n reaches R sqrt(1 - n_a^2) along axis a.
    const Vec3 reach = cylinder.radius * (1.0 - cylinder.axis.array().square()).max(0.0).sqrt().matrix();
    check_meets(section, domain, cylinder.base.cwiseMin(top) - reach, cylinder.base.cwiseMax(top) + reach);
    return cylinder;
}

/// The keys of balls, into a PowderSpec or a PowderLayer.
template <class Powder>
void read_balls(const Section& section, Powder& powder) {
    powder.d10 = section.above("d10", quantity::length, 0.0);
    powder.d50 = section.above("d50", quantity::length, 0.0);
    powder.d90 = section.above("d90", quantity::length, 0.0);
    if (powder.d50 < powder.d10) {
        section.fail("d50", fmt::format("must be at least d10 = {:g} m, is {:g} m", powder.d10, powder.d50));
    }
    if (powder.d90 < powder.d50) {
        section.fail("d90", fmt::format("must be at least d50 = {:g} m, is {:g} m", powder.d50, powder.d90));
    }
    powder.basis = section.choice("percentiles", words::percentiles, powder.basis);
    powder.packing = section.above("packing", quantity::number, 0.0, 0.74, powder.packing);
    powder.seed =
        static_cast<std::uint64_t>(section.integer("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
}

PowderSpec read_powder(const Section& section, const DomainSpec& domain) {
    PowderSpec powder;
    powder.box = read_box(section, domain);
    read_balls(section, powder);
    return powder;
}

const Material& read_material_name(const Section& section, const std::vector<Material>& materials) {
    std::vector<std::string> names;
    for (const Material& material : materials) {
        names.push_back(material.name);
    }
    const std::string name = section.word("material", names);
    return *std::find_if(materials.begin(), materials.end(),
                         [&](const Material& material) { return material.name == name; });
}

/// The packing of homogenised powder; none for state = "bulk" or without a state.
std::optional<double> read_homogenised(const Section& section, const Material& material) {
    if (!section.has("state") || section.word("state", {"bulk", "powder"}) == "bulk") {
        return std::nullopt;
    }
    if (!material.conductivity.powder) {
        section.fail("state",
                     fmt::format("\"powder\" needs conductivity.powder of material \"{}\"", material.name));
    }
    const double packing = section.above("packing", quantity::number, 0.0, 1.0, 0.5);
    if (packing == 1.0) {
        section.fail("packing", "must be below 1: state = \"bulk\" is what has no pores");
    }
    return packing;
}

const std::vector<std::pair<std::string, std::vector<std::string>>>& shape_keys() {
    static const std::vector<std::pair<std::string, std::vector<std::string>>> keys{
        {"box", {"min", "max"}},
        {"sphere", {"center", "radius"}},
        {"cylinder", {"base", "axis", "radius", "height"}},
        {"powder", {"min", "max", "d10", "d50", "d90", "percentiles", "packing", "seed"}},
        {"balls", {"file"}},
        {"stl", {"file", "scale"}}};
    return keys;
}

ShapeSpec read_shape(const Section& section, const std::string& shape, const DomainSpec& domain) {
    if (shape == "box") {
        return read_box(section, domain);
    }
    if (shape == "sphere") {
        return read_sphere(section, domain);
    }
    if (shape == "cylinder") {
        return read_cylinder(section, domain);
    }
    if (shape == "powder") {
        return read_powder(section, domain);
    }
    if (shape == "balls") {
        return BallsSpec{section.file("file")};
    }
    return StlSpec{section.file("file"), section.above("scale", quantity::length, 0.0, no_limit, 1.0)};
}

BodySpec read_body(const Section& section, const DomainSpec& domain, const std::vector<Material>& materials,
                   double ambient) {
    const std::vector<std::string> common{"shape", "material", "temperature"};
    const std::vector<std::string> of_solids{"state", "packing"};
    std::vector<std::string> shapes;
    std::vector<std::string> of_any_shape = common;
    for (const auto& [shape, keys] : shape_keys()) {
        shapes.push_back(shape);
        of_any_shape.insert(of_any_shape.end(), keys.begin(), keys.end());
    }
    of_any_shape.insert(of_any_shape.end(), of_solids.begin(), of_solids.end());
    if (!section.has("shape")) {
        section.allow_only(of_any_shape); // a misspelt "shape" is told as such
    }
    const std::string chosen = section.word("shape", shapes);
    for (const auto& [shape, keys] : shape_keys()) {
        if (shape == chosen) {
            std::vector<std::string> allowed = common;
            allowed.insert(allowed.end(), keys.begin(), keys.end());
            if (shape != "powder") {
                allowed.insert(allowed.end(), of_solids.begin(), of_solids.end());
            } else if (section.has("state")) {
                section.fail("state",
                             "belongs to the other shapes: shape = \"powder\" is resolved, ball by ball");
            }
            section.allow_only(allowed);
        }
    }
    BodySpec body;
    body.shape = read_shape(section, chosen, domain);
    const Material& material = read_material_name(section, materials);
    body.material = material.name;
    body.temperature = section.above("temperature", quantity::temperature, 0.0, highest_temperature, ambient);
    if (chosen != "powder") {
        body.powder_packing = read_homogenised(section, material);
        if (!body.powder_packing && section.has("packing")) {
            section.fail("packing", "belongs to state = \"powder\" or shape = \"powder\"");
        }
        if (body.powder_packing && body.temperature >= material.liquidus) {
            section.fail("temperature",
                         fmt::format("powder must start below the liquidus, {:g} K", material.liquidus));
        }
    }
    return body;
}

ScheduledLayer read_layer(const Section& section, const std::vector<Material>& materials, double ambient,
                          double end, std::optional<double> default_time) {
    std::vector<std::string> allowed{"time", "thickness", "material", "temperature", "state", "packing"};
    const bool homogenised = section.has("state");
    const std::vector<std::string> of_balls{"d10", "d50", "d90", "percentiles", "seed"};
    if (!homogenised) {
        allowed.insert(allowed.end(), of_balls.begin(), of_balls.end());
    }
    section.allow_only(allowed);
    ScheduledLayer scheduled;
    if (!section.has("time") && !default_time) {
        section.fail("time", "missing: there is no laser path at whose end the layer could come");
    }
    scheduled.time = section.in_range("time", quantity::time, 0.0, no_limit, default_time);
    if (!(scheduled.time < end)) {
        section.fail("time", fmt::format("must be before time.end = {:g} s, is {:g} s{}", end, scheduled.time,
                                         section.has("time") ? "" : ", the end of the laser paths"));
    }
    PowderLayer& layer = scheduled.layer;
    layer.thickness = section.above("thickness", quantity::length, 0.0);
    const Material& material = read_material_name(section, materials);
    layer.material = static_cast<std::int16_t>(&material - materials.data());
    layer.temperature = section.above("temperature", quantity::temperature, 0.0, material.liquidus, ambient);
    if (homogenised) {
        section.word("state", {"powder"});
        layer.homogenised = true;
        layer.packing = *read_homogenised(section, material);
    } else {
        read_balls(section, layer);
    }
    return scheduled;
}

FaceSpec read_face(const Section& boundary, const std::string& name, double ambient) {
    FaceSpec face;
    const toml::node* node = boundary.find(name);
    if (node == nullptr) {
        return face;
    }
    if (node->is_string()) {
        boundary.word(name, {"adiabatic"});
        return face;
    }
    const Section section = boundary.section(name, {"temperature", "convection", "ambient", "flux"});
    const int kinds = static_cast<int>(section.has("temperature")) +
                      static_cast<int>(section.has("convection")) + static_cast<int>(section.has("flux"));
    if (kinds != 1) {
        section.fail("expected \"adiabatic\" or a table with exactly one of temperature, convection, flux");
    }
    if (section.has("ambient") && !section.has("convection")) {
        section.fail("ambient", "belongs to convection");
    }
    if (section.has("temperature")) {
        face.kind = FaceSpec::Kind::temperature;
        face.temperature = section.above("temperature", quantity::temperature, 0.0, highest_temperature);
    } else if (section.has("convection")) {
        face.kind = FaceSpec::Kind::convection;
        face.convection = section.in_range("convection", quantity::heat_transfer_coefficient, 0.0, no_limit);
        face.ambient = section.above("ambient", quantity::temperature, 0.0, highest_temperature, ambient);
    } else {
        face.kind = FaceSpec::Kind::flux;
        face.flux = section.number("flux", quantity::heat_flux);
    }
    return face;
}

} // namespace

DomainSpec read_domain(const Section& section) {
    DomainSpec domain;
    domain.min = section.vector("min", quantity::length);
    domain.max = section.vector("max", quantity::length);
    check_box(section, domain.min, domain.max);
    domain.cell_size = section.above("cell_size", quantity::length, 0.0);
    check_whole_cells(section, domain);
    domain.particles_per_cell = static_cast<int>(section.integer("particles_per_cell", 1, 64, 8));
    const int count = domain.particles_per_cell;
    if (count != 1 && count != 8 && count != 27 && count != 64) {
        section.fail("particles_per_cell", fmt::format("must be 1, 8, 27 or 64, is {}", count));
    }
    return domain;
}

std::vector<BodySpec> read_bodies(const Section& root, const DomainSpec& domain,
                                  const std::vector<Material>& materials, double ambient) {
    std::vector<BodySpec> bodies;
    for (const Section& section : root.sections("body")) {
        bodies.push_back(read_body(section, domain, materials, ambient));
    }
    if (bodies.empty()) {
        root.fail("body", "missing: at least one [[body]] is needed");
    }
    return bodies;
}

std::vector<ScheduledLayer> read_layers(const Section& root, const std::vector<Material>& materials,
                                        const std::vector<Laser>& lasers, double ambient, double end) {
    std::optional<double> paths_end;
    for (const Laser& laser : lasers) {
        paths_end = std::max(paths_end.value_or(0.0), path_end_time(laser.path));
    }
    std::vector<ScheduledLayer> layers;
    for (const Section& section : root.sections("layer")) {
        layers.push_back(read_layer(section, materials, ambient, end, paths_end));
    }
    return layers;
}

std::array<FaceSpec, 6> read_boundary(const Section& root, double ambient) {
    const Section section = root.section("boundary", {face_names.begin(), face_names.end()});
    std::array<FaceSpec, 6> faces;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        faces[i] = read_face(section, face_names[i], ambient);
    }
    return faces;
}

} // namespace meltscope
