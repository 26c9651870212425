#include "example.hpp"

#include <fstream>

namespace meltscope {
namespace {

using test::complaint;
using test::example;
using test::with;

const std::filesystem::path materials = MELTSCOPE_SOURCE_DIR "/scenarios/materials";

TEST(material_file, those_that_come_with_the_program_are_valid_and_cite_their_sources) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(materials)) {
        const Material material = read_material(entry.path());
        EXPECT_EQ(material.name, entry.path().stem().string());
        EXPECT_GT(material.source.size(), 40u) << material.name;
        ++count;
    }
    EXPECT_GE(count, 4);
}

TEST(material_file, the_parabola_of_ti6al4v_stores_the_heat_of_its_source) {
    const Material material = read_material(materials / "ti6al4v.toml");
    const double steps = 100000;
    const double low = 298.15;
    double heat = 0.0;
    double source_heat = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double T = low + (i + 0.5) * (material.solidus - low) / steps;
        heat += material.heat_capacity.solid(T) * (material.solidus - low) / steps;
        source_heat +=
            (T < 1268.0 ? 483.04 + 0.215 * T : 412.70 + 0.1801 * T) * (material.solidus - low) / steps;
        const double kappa = T < 1268.0 ? 1.2595 + 0.0157 * T : 3.5127 + 0.0127 * T;
        EXPECT_NEAR(material.conductivity.solid(T), kappa, 0.93);
    }
    EXPECT_NEAR(heat / source_heat, 1.0, 1e-4);
}

TEST(material_file, impossible_figures_are_refused) {
    const auto said = [](const std::string& old_text, const std::string& new_text) {
        return complaint(with(old_text, new_text));
    };
    EXPECT_NE(said("solidus = 1650", "solidus = 1700")
                  .find("material.steel.liquidus: must be above the solidus, 1700 K"),
              std::string::npos);
    EXPECT_NE(said("density = 8000", "density = 0").find("material.steel.density: must be above 0"),
              std::string::npos);
    EXPECT_NE(
        said("solid = [20]", "solid = [20, -0.02]")
            .find(
                "material.steel.conductivity.solid: must be positive from 200 K to 1700 K, is -14 at 1700 K"),
        std::string::npos);
    EXPECT_NE(said("liquid = [700]", "liquid = [900, -0.6, 9e-5]") // dips between the ends
                  .find("heat_capacity.liquid: must be positive from 1650 K to 4500 K, is -100 at 3333.33 K"),
              std::string::npos)
        << said("liquid = [700]", "liquid = [900, -0.6, 9e-5]");
    EXPECT_NE(said("solid = [20]", "solid = []").find("expected a list of 1 to 3 numbers, found 0"),
              std::string::npos);
    EXPECT_NE(said("solid = [20]", "solid = [1, 2, 3, 4]").find("expected a list of 1 to 3 numbers, found 4"),
              std::string::npos);
    EXPECT_NE(said("density", "emissivity = 1.1\ndensity")
                  .find("material.steel.emissivity: must be at least 0 and at most 1"),
              std::string::npos);
    EXPECT_NE(said("density", "molar_mass = 55.8\ndensity").find("material.steel.molar_mass"),
              std::string::npos);
    EXPECT_NE(said("density", "boiling_point = 1000\ndensity")
                  .find("material.steel.boiling_point: must be above 1700"),
              std::string::npos);
}

TEST(material_file, a_loss_that_is_on_needs_its_figures) {
    EXPECT_NE(complaint(with("radiation = false", "radiation = true"))
                  .find("track.toml:8:1: material.steel.emissivity: missing, and physics.radiation = true "
                        "needs it of "
                        "material \"steel\""),
              std::string::npos);
    const std::string boiling = with("density", "boiling_point = 3000\ndensity");
    EXPECT_NE(complaint(with("radiation = false", "evaporation = true", boiling))
                  .find("material.steel.latent_heat_of_vaporization: missing"),
              std::string::npos);
    EXPECT_EQ(complaint(with("radiation = false", "radiation = true",
                             with("density", "emissivity = 0.4\ndensity"))),
              "");
}

TEST(material_file, mistakes_in_a_file_carry_the_files_own_lines) {
    const std::filesystem::path folder = ::testing::TempDir();
    std::ofstream(folder / "odd_steel.toml")
        << "density = 8000\nsolidus = 1650\nliquidus = 1700\nlatnt_heat = 1\n";
    const std::string said = complaint("materials = [\"odd_steel.toml\"]\n" + example, {}, folder);
    EXPECT_NE(
        said.find(
            "odd_steel.toml:4:1: material.odd_steel.latnt_heat: unknown key; did you mean \"latent_heat\"?"),
        std::string::npos)
        << said;
    std::ofstream(folder / "odd_steel.toml") << "density = \n";
    const std::string broken = complaint("materials = [\"odd_steel.toml\"]\n" + example, {}, folder);
    EXPECT_NE(broken.find("odd_steel.toml:1:"), std::string::npos) << broken;
}

TEST(material_file, missing_files_and_names_used_twice_are_refused) {
    EXPECT_NE(complaint("materials = [\"none.toml\"]\n" + example)
                  .find("track.toml:1:14: materials[0]: there is no file"),
              std::string::npos);
    EXPECT_NE(complaint("materials = [\"in625.toml\", \"in625.toml\"]\n" + example, {}, materials)
                  .find("materials: there is a material called \"in625\" already"),
              std::string::npos);
}

} // namespace
} // namespace meltscope
