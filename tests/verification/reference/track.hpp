#pragma once

#include "reference/driver.hpp"
#include "reference/eagar_tsai.hpp"

#include "meltscope/beam/illumination.hpp"

namespace meltscope::verification {

/// A Gaussian beam on a bare plate of constant properties, all in units of the beam: sigma = kappa = rho = c
/// = 1, so that speed is the Peclet number. Half of the plate, y >= 0, stands for both.
struct TrackCase {
    double peclet = 7.0;
    int cells_in_sigma = 4;
    double length = 12.0, half_width = 4.0, depth = 3.0; ///< sigma
    double start = 3.0;                                  ///< sigma, x where the beam begins
    double peak_rise = 500.0; ///< K, of the steady state; the plate starts at 1000 K
    bool at_surface = true;   ///< deposit at the foot points, or at the particles of the band
    Stepping stepping;
};

inline constexpr double plate_temperature = 1000.0; // K

/// The plate under the beam; x runs along the track, z = 0 is the surface.
class Track {
  public:
    ThermalRun run;
    FreeSurface surface;
    EagarTsai exact;
    double absorbed = 0.0;    ///< J
    double worst_scale = 1.0; ///< of Absorption::scale, furthest from one

    explicit Track(const TrackCase& c)
        : run(make_run(c)), surface(find_free_surface(run.grid, run.particles, run.nodes, {}, c.at_surface)),
          map_(make_light_map(run.grid, surface, Vec3(0, 0, -1))) {
        exact.speed = c.peclet;
        exact.start = c.start;
        exact.x_low = 0.0;
        exact.x_high = c.length;
        exact.half_width = c.half_width;
        exact.depth = c.depth;
        double steady_peak = 0.0;
        for (double x = -3.0; x < 0.5; x += 0.01)
            steady_peak = std::max(steady_peak, exact.steady_rise(Vec3(x, 0, 0)));
        exact.absorbed_power = c.peak_rise / steady_peak;
        laser_.power = exact.absorbed_power;
        laser_.absorptivity = 1.0;
        laser_.spot_radius = 2.0; // D4sigma = 4 sigma
    }

    /// Runs one pass of `duration`, the beam moving from the start.
    void pass(double duration) {
        double t = 0.0;
        ElementHeat heat;
        run.advance(duration, 1.0, [&](double dt) {
            const Absorption a = absorb(map_, laser_, Vec3(exact.beam(t + 0.5 * dt), 0, 0), laser_.power,
                                        surface.elements, heat);
            for (double& value : heat.amount)
                value *= dt;
            deposit(run.grid, surface.elements, heat, run.nodes);
            absorbed += a.absorbed * dt;
            if (std::abs(a.scale - 1.0) > std::abs(worst_scale - 1.0))
                worst_scale = a.scale;
            t += dt;
        });
    }

    /// Rise in K of the node temperatures, interpolated.
    double rise(const Vec3& x) const { return run.temperature(x) - plate_temperature; }

  private:
    LightMap map_;
    Laser laser_;

    static ThermalRun make_run(const TrackCase& c) {
        const int n = c.cells_in_sigma;
        const Index3 cells(std::lround(c.length * n), std::lround(c.half_width * n),
                           std::lround(c.depth * n) + 3);
        const Grid grid = make_grid(Vec3(0, 0, -c.depth), 1.0 / n, cells);
        const std::vector<EquationOfState> materials{make_equation_of_state(constant_material())};
        ParticleList list = lattice_points(grid, 2, [](const Vec3& x) { return x[2] < 0.0; });
        set_state(
            materials, [](const Vec3&) { return plate_temperature; }, list);
        return ThermalRun(grid, materials, Boundary{}, std::move(list), 2, c.stepping);
    }
};

} // namespace meltscope::verification
