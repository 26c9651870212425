#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// The pictures and data files of a run. These headers know no VTK, so the program can include them as they
/// are.
namespace meltscope::viz {

/// Anything that goes wrong with pictures, files or movies; the message says what and what would be right.
class VizError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

enum class Compression { none, lz4, zlib };
enum class Precision { float32, float64 };
enum class Background { dark, light };

/// Where a render window may come from. `automatic` takes a usable DISPLAY, else a private Xvfb, else
/// nothing; egl and osmesa need VTK 9.4 or later.
enum class Backend { automatic, x11, xvfb, egl, osmesa, none };

/// Which files an output writes and how.
struct FileOptions {
    std::filesystem::path run_dir;
    bool surface = true;           ///< surface/*.vtp, the free surface
    bool pool = true;              ///< pool/*.vtp, the liquidus isosurface
    bool grid = false;             ///< grid/*.vti, the node fields
    bool particles = true;         ///< particles/*.vtp, whatever particles the snapshot holds
    bool particles_as_vtu = false; ///< the same points as *.vtu
    Compression compression = Compression::none;
    Precision precision = Precision::float32;
};

/// What the pictures look like.
struct RenderOptions {
    std::filesystem::path run_dir;
    std::array<int, 2> size{1280, 720};         ///< pixels
    std::vector<std::string> views{"overview"}; ///< of view_names()
    std::string field = "temperature";          ///< of field_names()
    /// Range of the field's colours, in its unit. Unset: chosen at the first picture and kept for the whole
    /// run.
    std::optional<std::array<double, 2>> color_range;
    std::string colormap = "inferno"; ///< of colormap_names()
    Background background = Background::dark;
};

/// What happens when the solver is faster than the pictures.
struct BacklogPolicy {
    enum class OnFull { wait, drop } on_full = OnFull::wait;
    int capacity = 2; ///< snapshots waiting at most, 1 or more
};

/// overview, section, top, pool, dashboard.
const std::vector<std::string>& view_names();
/// temperature, phi, phi_hat, mass.
const std::vector<std::string>& field_names();
/// inferno, magma, plasma, viridis, cividis.
const std::vector<std::string>& colormap_names();

/// The backend of that name (auto, x11, xvfb, egl, osmesa, none); throws VizError that lists the names.
Backend backend_from_name(std::string_view name);
std::string_view backend_name(Backend backend);

/// Throws VizError for an unknown view, field or colour map, an empty or reversed range, or a picture size
/// outside 64 to 16384.
void validate(const RenderOptions& options);

} // namespace meltscope::viz
