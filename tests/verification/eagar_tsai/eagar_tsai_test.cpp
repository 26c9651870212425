#include "reference/table.hpp"
#include "reference/track.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

struct Errors {
    double surface = 0.0; ///< largest on the track's centre line, by the peak rise
    double depth = 0.0;   ///< largest below it
    double rms = 0.0;
};

/// Along the track, 3 sigma about the beam, and on the 2 sigma below it; writes the profiles if asked to.
Errors compare(const Track& track, const TrackCase& c, ResultTable* profile = nullptr) {
    const int n = c.cells_in_sigma;
    const double beam = track.exact.beam(track.run.time);
    Errors errors;
    double count = 0.0;
    for (int d = 0; d <= 2 * n; ++d)
        for (int i = -3 * n; i <= 3 * n; ++i) {
            const Vec3 x(beam + double(i) / n, 0.0, -double(d) / n);
            const double exact = track.exact.rise(x, track.run.time) / c.peak_rise;
            const double got = track.rise(x) / c.peak_rise;
            double& most = d == 0 ? errors.surface : errors.depth;
            most = std::max(most, std::abs(got - exact));
            errors.rms += (got - exact) * (got - exact);
            count += 1.0;
            if (profile && (d == 0 || i == 0))
                profile->row({double(d) / n, double(i) / n, exact, got});
        }
    errors.rms = std::sqrt(errors.rms / count);
    return errors;
}

/// Sizes for a Peclet number: the beam goes a few sigma, until what it left behind hardly matters where it
/// is.
TrackCase track_case(double peclet, int cells_in_sigma) {
    TrackCase c;
    c.peclet = peclet;
    c.cells_in_sigma = cells_in_sigma;
    const double way = peclet > 4.0 ? 5.0 : 4.0; // sigma
    c.start = 3.5;
    c.length = c.start + way + 3.5;
    c.half_width = 4.0;
    c.depth = 3.0;
    return c;
}

double duration(const TrackCase& c) {
    return (c.length - 3.5 - c.start) / c.peclet;
}

void expect_profiles(double peclet, int cells_in_sigma, double allowed) {
    const TrackCase c = track_case(peclet, cells_in_sigma);
    Track track(c);
    track.pass(duration(c));
    const std::string name =
        "eagar_tsai_pe" + std::to_string(int(peclet)) + "_" + std::to_string(cells_in_sigma) + "dx";
    ResultTable profile(name + "_profiles", "depth,x,exact,computed");
    ResultTable table(name, "peclet,cells_in_sigma,surface_percent,depth_percent,rms_percent,scale,energy_"
                            "residual,spread_percent");
    const Errors errors = compare(track, c, &profile);
    const double residual =
        std::abs(total_energy(track.run.particles) - track.run.start_energy - track.absorbed) /
        track.absorbed;
    table.row({peclet, double(cells_in_sigma), 100.0 * errors.surface, 100.0 * errors.depth,
               100.0 * errors.rms, track.worst_scale, residual, 100.0 * track.run.spread() / c.peak_rise});
    EXPECT_LT(errors.surface, allowed);
    EXPECT_LT(errors.depth, allowed);
    EXPECT_LT(residual, 1e-11);
    EXPECT_NEAR(track.worst_scale, 1.0, 0.01);
}

TEST(EagarTsai, peclet_1_on_4_cells_a_sigma_within_3_percent) {
    expect_profiles(1.0, 4, 0.03);
}
TEST(EagarTsai, peclet_2_on_4_cells_a_sigma_within_3_percent) {
    expect_profiles(2.0, 4, 0.03);
}
TEST(EagarTsai, peclet_7_on_4_cells_a_sigma_within_3_percent) {
    expect_profiles(7.0, 4, 0.03);
}
TEST(EagarTsai, peclet_1_on_8_cells_a_sigma_within_1_percent) {
    expect_profiles(1.0, 8, 0.01);
}
TEST(EagarTsai, peclet_2_on_8_cells_a_sigma_within_1_percent) {
    expect_profiles(2.0, 8, 0.01);
}
TEST(EagarTsai, peclet_7_on_8_cells_a_sigma_within_1_percent) {
    expect_profiles(7.0, 8, 0.01);
}

TEST(EagarTsai, halving_the_time_step_changes_the_profiles_by_less_than_1_percent) {
    ResultTable table("eagar_tsai_time_step", "cfl,surface_percent,depth_percent,change_percent");
    TrackCase c = track_case(7.0, 4);
    std::vector<double> before;
    for (const double cfl : {0.8, 0.5, 0.25, 0.125}) {
        c.stepping.cfl = cfl;
        Track track(c);
        track.pass(duration(c));
        const double beam = track.exact.beam(track.run.time);
        std::vector<double> now;
        for (int d = 0; d <= 8; ++d)
            for (int i = -12; i <= 12; ++i)
                now.push_back(track.rise(Vec3(beam + i / 4.0, 0.0, -d / 4.0)) / c.peak_rise);
        double change = 0.0;
        for (std::size_t p = 0; p < before.size(); ++p)
            change = std::max(change, std::abs(now[p] - before[p]));
        EXPECT_LT(change, 0.01) << "from the step before to " << cfl;
        const Errors errors = compare(track, c);
        table.row({cfl, 100.0 * errors.surface, 100.0 * errors.depth, 100.0 * change});
        before = std::move(now);
    }
}

TEST(EagarTsai, the_origin_and_the_depth_sigma_have_the_values_of_the_table) {
    // What the steady state has beyond the run's time and less than its walls is taken from the integral.
    ResultTable table("eagar_tsai_table",
                      "peclet,depth,table,computed,error_percent_of_peak,from_integral_percent");
    for (const int peclet : {1, 2}) {
        const TrackCase c = track_case(peclet, 4);
        Track track(c);
        track.pass(duration(c));
        const double beam = track.exact.beam(track.run.time);
        for (const double depth : {0.0, 1.0}) {
            const std::string end = " Pe=" + std::to_string(peclet);
            const double expected =
                reference_value("eagar_tsai", (depth == 0.0 ? "theta origin" : "theta at depth sigma") + end);
            const Vec3 x(beam, 0.0, -depth);
            const double rest =
                track.exact.steady_rise(Vec3(0, 0, -depth)) - track.exact.rise(x, track.run.time);
            const double theta = (track.rise(x) + rest) / track.exact.absorbed_power;
            const double peak = c.peak_rise / track.exact.absorbed_power;
            EXPECT_LT(std::abs(theta - expected), 0.03 * peak) << "Pe " << peclet << ", depth " << depth;
            table.row({double(peclet), depth, expected, theta, 100.0 * (theta - expected) / peak,
                       100.0 * rest / c.peak_rise});
        }
    }
}

TEST(EagarTsai, values_alone_and_heat_in_the_band_are_worse) {
    ResultTable table("eagar_tsai_forms", "form,surface_percent,depth_percent,rms_percent,spread_percent");
    struct Form {
        const char* name;
        bool affine, at_surface;
    };
    double best = 0.0;
    for (const Form& form : {Form{"affine surface", true, true}, Form{"affine band", true, false},
                             Form{"flip surface", false, true}, Form{"flip band", false, false}}) {
        TrackCase c = track_case(7.0, 4);
        c.at_surface = form.at_surface;
        c.stepping.affine = form.affine;
        c.stepping.blend = form.affine ? -1.0 : 0.0;
        Track track(c);
        track.pass(duration(c));
        const Errors errors = compare(track, c);
        const double worst = std::max(errors.surface, errors.depth);
        if (form.affine && form.at_surface)
            best = worst;
        else
            EXPECT_GT(worst, 2.0 * best) << form.name;
        table.row(form.name, {100.0 * errors.surface, 100.0 * errors.depth, 100.0 * errors.rms,
                              100.0 * track.run.spread() / c.peak_rise});
    }
}

} // namespace
} // namespace meltscope::verification
