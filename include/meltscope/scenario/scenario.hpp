#pragma once

#include "meltscope/beam/laser.hpp"
#include "meltscope/build/powder.hpp"
#include "meltscope/build/shapes.hpp"
#include "meltscope/material/material.hpp"
#include "meltscope/run/powder_layer.hpp"
#include "meltscope/vec3.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// What a scenario file says, as plain data in SI units. Nothing here opens a file or computes anything.
namespace meltscope {

/// The block of space that is simulated, cut into cubes.
struct DomainSpec {
    Vec3 min = Vec3::Zero();    ///< m, lower corner
    Vec3 max = Vec3::Zero();    ///< m, upper corner; max - min is a whole number of cells along each axis
    double cell_size = 0.0;     ///< m
    int particles_per_cell = 8; ///< 1, 8, 27 or 64 on a cubic lattice

    /// Whole cells along x, y, z.
    Index3 cells() const { return ((max - min) / cell_size).array().round().cast<std::int64_t>(); }
    /// m, distance between neighbouring lattice particles.
    double particle_spacing() const;
};

/// Balls from a table (columns x, y, z, r in metres).
struct BallsSpec {
    std::filesystem::path file; ///< absolute
};
/// A closed triangle mesh.
struct StlSpec {
    std::filesystem::path file; ///< absolute
    double scale = 1.0;         ///< m for one unit of the file (0.001 for a file in millimetres)
};

/// What a body is made as; the files are read when it is built. A cylinder's axis is unit.
using ShapeSpec = std::variant<Box, Sphere, Cylinder, PowderSpec, BallsSpec, StlSpec>;

/// One body. A later body replaces an earlier one where both are.
struct BodySpec {
    ShapeSpec shape;
    std::string material;        ///< name of one of the scenario's materials
    double temperature = 298.15; ///< K at the start; by default physics.ambient
    /// state = "powder": homogenised powder of this packing (share of its volume that is solid); unset: bulk
    std::optional<double> powder_packing;
};

/// What holds on one face of the domain.
struct FaceSpec {
    enum class Kind { adiabatic, temperature, convection, flux };
    Kind kind = Kind::adiabatic;
    double temperature = 0.0; ///< K, of a face held at it
    double convection = 0.0;  ///< W/m^2/K, heat transfer coefficient
    double ambient = 0.0;     ///< K, beyond a convecting face
    double flux = 0.0;        ///< W/m^2, positive into the domain
};

/// Which of the numerical forms and physical effects are on.
struct PhysicsSpec {
    enum class Diffusion { temperature, energy };
    enum class Transfer { affine, flip };
    enum class Deposit { surface, band };
    Diffusion diffusion = Diffusion::temperature;
    Transfer transfer = Transfer::affine;
    Deposit deposit = Deposit::surface;
    std::optional<double> blend_time; ///< s, tau of b = min(1, dt/tau); by default the solver's choice
    bool radiation = false;
    bool evaporation = false;
    bool reabsorption = false;         ///< of radiation by surfaces that see each other; needs radiation
    double convection = 0.0;           ///< W/m^2/K, heat transfer coefficient of the free surface
    double ambient = 298.15;           ///< K, of the surroundings
    double quiescent_tolerance = 1e-6; ///< K, see PhysicsOptions
};

struct LevelSetSpec {
    double radius = 1.0;  ///< particle radius of the first estimate, in particle spacings
    double epsilon = 0.5; ///< width of the regularised level set, in cells
};

struct TimeSpec {
    double end = 0.0;               ///< s
    double cfl = 0.5;               ///< share of the explicit limit, in (0, 1]
    std::optional<double> max_step; ///< s
};

struct OutputSpec {
    enum class Particles { surface, melt, all, none };
    enum class Compression { none, lz4, zlib };
    enum class Precision { float32, float64 };
    enum class ParticlesFormat { vtp, vtu };
    enum class PoolRows { output, step };
    std::optional<double> every;             ///< s; exactly one of every and every_steps is set
    std::optional<std::int64_t> every_steps; ///< steps; default: every = time.end / 20
    Particles particles = Particles::surface;
    bool surface = true;
    bool pool = true;
    bool grid = false;
    bool solidification = false; ///< solidification data of every node that freezes
    Compression compression = Compression::none;
    Precision precision = Precision::float32;
    ParticlesFormat particles_format = ParticlesFormat::vtp;
    PoolRows pool_rows = PoolRows::output; ///< the melt-pool tables have a row an output, or a step
    std::vector<double>
        isotherms; ///< K, pool figures are made for each; default: liquidus of the first material
};

struct RenderSpec {
    enum class OnBacklog { wait, drop };
    enum class Background { dark, light };
    std::optional<double> every;                      ///< s; by default a picture at each output
    std::array<int, 2> size{1280, 720};               ///< pixels, even
    std::vector<std::string> views{"overview"};       ///< of view_names()
    std::optional<std::array<double, 2>> color_range; ///< K, cold end and hot end of the colour bar
    std::string colormap = "inferno";                 ///< of colormap_names()
    OnBacklog on_backlog = OnBacklog::wait;
    Background background = Background::dark;
};

struct CheckpointSpec {
    std::optional<double> every; ///< s of simulated time; none: only when asked for or stopped
    int keep = 2;                ///< newest checkpoints kept
};

/// Faces in the order x_min, x_max, y_min, y_max, z_min, z_max.
inline constexpr std::array<const char*, 6> face_names{"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};

/// A whole scenario: everything a run depends on, defaults filled in, material files and path files read.
struct Scenario {
    std::string title;
    DomainSpec domain;
    std::vector<BodySpec> bodies;
    std::vector<Material> materials;    ///< in the order of the file: `materials` first, then [material.NAME]
    std::array<FaceSpec, 6> boundary;   ///< in the order of face_names
    std::vector<Laser> lasers;          ///< paths resolved, from wherever they came
    std::vector<ScheduledLayer> layers; ///< of powder, laid during the run
    PhysicsSpec physics;
    LevelSetSpec level_set;
    TimeSpec time;
    OutputSpec output;
    RenderSpec render;
    CheckpointSpec checkpoint;
};

/// Index in scenario.materials of the material called `name`; throws std::out_of_range if there is none.
std::size_t material_index(const Scenario& scenario, const std::string& name);

/// What of a scenario is allowed but has no effect, or is too coarse for good results; for the log.
std::vector<std::string> scenario_notes(const Scenario& scenario);

/// Views and colour maps a scenario may name.
const std::vector<std::string>& view_names();
const std::vector<std::string>& colormap_names();

} // namespace meltscope
