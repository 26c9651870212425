#include "meltscope/scenario/scenario_file.hpp"

#include "scenario_parts.hpp"
#include "scenario_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace meltscope {
namespace {

constexpr double most_outputs = 999999.0; // names of files carry six digits

PhysicsSpec read_physics(const Section& root) {
    const Section section =
        root.section("physics", {"diffusion", "transfer", "deposit", "blend_time", "radiation", "evaporation",
                                 "reabsorption", "convection", "ambient", "quiescent_tolerance"});
    PhysicsSpec physics;
    physics.diffusion = section.choice("diffusion", words::diffusion, physics.diffusion);
    physics.transfer = section.choice("transfer", words::transfer, physics.transfer);
    physics.deposit = section.choice("deposit", words::deposit, physics.deposit);
    physics.blend_time = section.maybe_above("blend_time", quantity::time, 0.0);
    if (physics.blend_time && physics.transfer == PhysicsSpec::Transfer::flip) {
        section.fail("blend_time", "belongs to transfer = \"affine\"; \"flip\" never blends");
    }
    physics.radiation = section.flag("radiation", physics.radiation);
    physics.evaporation = section.flag("evaporation", physics.evaporation);
    physics.reabsorption = section.flag("reabsorption", physics.reabsorption);
    if (physics.reabsorption && !physics.radiation) {
        section.fail("reabsorption", "needs radiation = true: it is radiation that is absorbed again");
    }
    physics.convection = section.in_range("convection", quantity::heat_transfer_coefficient, 0.0, no_limit,
                                          physics.convection);
    physics.ambient =
        section.above("ambient", quantity::temperature, 0.0, highest_temperature, physics.ambient);
    physics.quiescent_tolerance =
        section.in_range("quiescent_tolerance", quantity::temperature_difference, 0.0,
                         highest_quiescent_tolerance, physics.quiescent_tolerance);
    return physics;
}

LevelSetSpec read_level_set(const Section& root) {
    const Section section = root.section("level_set", {"radius", "epsilon"});
    LevelSetSpec level_set;
    // Below 0.87 spacings (half a cell diagonal) the balls of a lattice leave holes between them.
    level_set.radius = section.in_range("radius", quantity::number, 0.87, 4.0, level_set.radius);
    level_set.epsilon = section.in_range("epsilon", quantity::number, 0.05, 4.0, level_set.epsilon);
    return level_set;
}

TimeSpec read_time(const Section& root) {
    root.require("time");
    const Section section = root.section("time", {"end", "cfl", "max_step"});
    TimeSpec time;
    time.end = section.above("end", quantity::time, 0.0);
    time.cfl = section.above("cfl", quantity::number, 0.0, 1.0, time.cfl);
    time.max_step = section.maybe_above("max_step", quantity::time, 0.0);
    return time;
}

/// An interval of simulated time that does not give more files than their names can count.
std::optional<double> read_interval(const Section& section, const TimeSpec& time) {
    const std::optional<double> every = section.maybe_above("every", quantity::time, 0.0);
    if (every && !(time.end / *every <= most_outputs)) {
        section.fail("every",
                     fmt::format("gives more than {:.0f} outputs until time.end = {:g} s; at least {:g} s is "
                                 "possible",
                                 most_outputs, time.end, time.end / most_outputs));
    }
    return every;
}

OutputSpec read_output(const Section& root, const TimeSpec& time, const Material& first_material) {
    const Section section = root.section("output", {"every", "every_steps", "particles", "particles_format",
                                                    "surface", "pool", "grid", "compression", "precision",
                                                    "solidification", "isotherms", "pool_rows"});
    OutputSpec output;
    if (section.has("every") && section.has("every_steps")) {
        section.fail("every_steps", "every is given as well; only one of the two can hold");
    }
    output.every = read_interval(section, time);
    if (section.has("every_steps")) {
        output.every_steps = section.integer("every_steps", 1, std::numeric_limits<std::int64_t>::max());
    } else if (!output.every) {
        output.every = time.end / 20.0;
    }
    output.particles = section.choice("particles", words::particles, output.particles);
    output.particles_format =
        section.choice("particles_format", words::particles_format, output.particles_format);
    output.pool_rows = section.choice("pool_rows", words::pool_rows, output.pool_rows);
    output.surface = section.flag("surface", output.surface);
    output.pool = section.flag("pool", output.pool);
    output.grid = section.flag("grid", output.grid);
    output.solidification = section.flag("solidification", output.solidification);
    output.compression = section.choice("compression", words::compression, output.compression);
    output.precision = section.choice("precision", words::precision, output.precision);
    output.isotherms = {first_material.liquidus};
    if (section.has("isotherms")) {
        output.isotherms = section.numbers("isotherms", quantity::temperature, 1, 16);
        std::set<double> seen;
        for (const double isotherm : output.isotherms) {
            if (!(isotherm > 0.0 && isotherm <= highest_temperature)) {
                section.fail("isotherms", fmt::format("must be above 0 and at most {:g} K, one is {:g} K",
                                                      highest_temperature, isotherm));
            }
            if (!seen.insert(isotherm).second) {
                section.fail("isotherms", fmt::format("{:g} K stands there twice", isotherm));
            }
        }
    }
    return output;
}

RenderSpec read_render(const Section& root, const TimeSpec& time) {
    const Section section = root.section(
        "render", {"every", "size", "views", "color_range", "colormap", "on_backlog", "background"});
    RenderSpec render;
    render.every = read_interval(section, time);
    if (section.has("size")) {
        const std::vector<double> size = section.numbers("size", quantity::number, 2, 2);
        for (std::size_t i = 0; i < 2; ++i) {
            // Even, since H.264 with yuv420p halves the colour's resolution; 8192 is what renderers are sure
            // to take.
            if (!(size[i] >= 16.0 && size[i] <= 8192.0) || std::fmod(size[i], 2.0) != 0.0) {
                section.fail("size",
                             fmt::format("width and height must be even numbers from 16 to 8192, one is {:g}",
                                         size[i]));
            }
            render.size[i] = static_cast<int>(size[i]);
        }
    }
    if (section.has("views")) {
        render.views = section.words("views", view_names());
    }
    if (section.has("color_range")) {
        const std::vector<double> range = section.numbers("color_range", quantity::temperature, 2, 2);
        if (!(range[0] >= 0.0 && range[1] > range[0])) {
            section.fail("color_range",
                         fmt::format("must rise from a temperature to a higher one, is {:g} to {:g} K",
                                     range[0], range[1]));
        }
        render.color_range = {range[0], range[1]};
    }
    if (section.has("colormap")) {
        render.colormap = section.word("colormap", colormap_names());
    }
    render.on_backlog = section.choice("on_backlog", words::on_backlog, render.on_backlog);
    render.background = section.choice("background", words::background, render.background);
    return render;
}

CheckpointSpec read_checkpoint(const Section& root, const TimeSpec& time) {
    const Section section = root.section("checkpoint", {"every", "keep"});
    CheckpointSpec checkpoint;
    checkpoint.every = read_interval(section, time);
    checkpoint.keep = static_cast<int>(section.integer("keep", 1, 1000000, checkpoint.keep));
    return checkpoint;
}

/// Replaces `materials = [files]` by the files' tables, as if they were written inline; returns their names
/// in order.
std::vector<std::string> inline_material_files(const ReadContext& context, toml::table& tree) {
    const Section root(context, tree, "");
    if (!root.has("materials")) {
        return {};
    }
    std::vector<std::string> names;
    std::vector<toml::table> tables;
    for (const std::filesystem::path& file : root.files("materials")) {
        names.push_back(file.stem().string());
        tables.push_back(parse_toml(read_text_file(file, file.string()), file.string()));
    }
    if (!root.has("material")) {
        tree.insert("material", toml::table{});
    }
    root.table("material"); // refuses what is no table
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (!tree["material"].as_table()->insert(names[i], std::move(tables[i])).second) {
            root.fail("materials", fmt::format("there is a material called \"{}\" already", names[i]));
        }
    }
    tree.erase("materials");
    return names;
}

/// Names of all materials: those of files first, then inline ones as they stand in the text (a TOML table has
/// no order).
std::vector<std::string> ordered_material_names(const toml::table& materials,
                                                std::vector<std::string> names) {
    std::vector<std::pair<toml::source_position, std::string>> inline_names;
    for (const auto& [key, node] : materials) {
        if (std::find(names.begin(), names.end(), key.str()) == names.end()) {
            inline_names.emplace_back(key.source().begin, key.str());
        }
    }
    std::stable_sort(inline_names.begin(), inline_names.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [place, name] : inline_names) {
        names.push_back(name);
    }
    return names;
}

/// A switched-on loss needs figures of every material that is in the scenario.
void check_losses(const PhysicsSpec& physics, const Material& material, const Section& section) {
    const auto need = [&](bool on, bool there, const char* key, const char* effect) {
        if (on && !there) {
            section.fail(key, fmt::format("missing, and physics.{} = true needs it of material \"{}\"",
                                          effect, material.name));
        }
    };
    need(physics.radiation, material.emissivity.has_value(), "emissivity", "radiation");
    need(physics.evaporation, material.boiling_point.has_value(), "boiling_point", "evaporation");
    need(physics.evaporation, material.latent_heat_of_vaporization.has_value(), "latent_heat_of_vaporization",
         "evaporation");
    need(physics.evaporation, material.molar_mass.has_value(), "molar_mass", "evaporation");
}

bool holds_control_character(std::string_view text) {
    return std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
}

std::vector<Material> read_materials(const Section& root, const std::vector<std::string>& from_files,
                                     const PhysicsSpec& physics) {
    if (!root.has("material")) {
        root.fail("materials", "missing: a list of material files, or [material.NAME] sections, are needed");
    }
    const Section section(root.context(), root.table("material"), "material");
    std::vector<Material> materials;
    for (const std::string& name : ordered_material_names(root.table("material"), from_files)) {
        if (name.empty() || name.find('"') != std::string::npos || holds_control_character(name)) {
            section.fail(
                "the name of a material must be of printable characters without quotation marks, since "
                "commands name it");
        }
        const Section one(root.context(), section.table(name), joined_key("material", name));
        materials.push_back(read_material_section(one, name));
        check_losses(physics, materials.back(), one);
    }
    if (materials.empty()) {
        root.fail("material", "is empty: at least one material is needed");
    }
    return materials;
}

Scenario read_tree(const Section& root, const std::vector<std::string>& material_files) {
    root.allow_only({"title", "domain", "body", "materials", "material", "boundary", "laser", "physics",
                     "level_set", "time", "output", "render", "checkpoint", "layer"});
    Scenario scenario;
    scenario.title = root.has("title") ? root.text("title") : "";
    if (holds_control_character(scenario.title)) {
        root.fail("title", "must be one line of printable characters: terminals and pictures show it");
    }
    root.require("domain");
    scenario.domain = read_domain(root.section("domain", {"min", "max", "cell_size", "particles_per_cell"}));
    scenario.physics = read_physics(root);
    scenario.materials = read_materials(root, material_files, scenario.physics);
    scenario.bodies = read_bodies(root, scenario.domain, scenario.materials, scenario.physics.ambient);
    scenario.boundary = read_boundary(root, scenario.physics.ambient);
    scenario.lasers = read_lasers(root, scenario.domain);
    scenario.level_set = read_level_set(root);
    scenario.time = read_time(root);
    scenario.layers =
        read_layers(root, scenario.materials, scenario.lasers, scenario.physics.ambient, scenario.time.end);
    scenario.output = read_output(root, scenario.time, scenario.materials.front());
    scenario.render = read_render(root, scenario.time);
    scenario.checkpoint = read_checkpoint(root, scenario.time);
    return scenario;
}

} // namespace

Scenario read_scenario_text(std::string_view text, const std::vector<std::string>& overrides,
                            const std::string& name, const std::filesystem::path& folder) {
    const ReadContext context{name, folder};
    toml::table tree = parse_toml(text, name);
    // Overrides of materials come after the files are read, so that they reach into them.
    std::vector<Override> of_materials;
    for (const std::string& text_of_one : overrides) {
        Override change = parse_override(text_of_one);
        if (change.components.front() == "material") {
            of_materials.push_back(std::move(change));
        } else {
            apply_override(tree, std::move(change));
        }
    }
    const std::vector<std::string> material_files = inline_material_files(context, tree);
    for (Override& change : of_materials) {
        apply_override(tree, std::move(change));
    }
    return read_tree(Section(context, tree, ""), material_files);
}

Scenario read_scenario(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    return read_scenario_text(read_text_file(file, file.string()), overrides, file.string(),
                              file.parent_path());
}

} // namespace meltscope
