#include "meltscope/build/powder.hpp"

#include "meltscope/constants.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace meltscope {
namespace {

constexpr double um = 1e-6;

PowderSpec bed_spec() {
    PowderSpec spec;
    spec.box = {Vec3(-100 * um, 50 * um, 10 * um), Vec3(300 * um, 350 * um, 130 * um)};
    spec.d10 = 20 * um;
    spec.d50 = 30 * um;
    spec.d90 = 42 * um;
    spec.packing = 0.5;
    spec.seed = 7;
    return spec;
}

double total_volume(const std::vector<Ball>& balls) {
    double sum = 0.0;
    for (const Ball& ball : balls) {
        sum += 4.0 / 3.0 * constants::pi * std::pow(ball.radius, 3);
    }
    return sum;
}

/// Largest overlap of any two balls by the smaller diameter.
double worst_overlap(const std::vector<Ball>& balls, const std::vector<Ball>& others) {
    double worst = 0.0;
    for (const Ball& a : balls) {
        for (const Ball& b : others) {
            const double overlap = a.radius + b.radius - (a.center - b.center).norm();
            if (&a != &b && (a.center != b.center)) {
                worst = std::max(worst, 0.5 * overlap / std::min(a.radius, b.radius));
            }
        }
    }
    return worst;
}

/// Directions in which a ball is pushed by what lies within a two hundredth of d50 of it.
std::vector<Vec3> contact_normals(const PowderSpec& spec, const std::vector<Ball>& balls, const Ball& ball) {
    const double tolerance = 5e-3 * spec.d50;
    std::vector<Vec3> normals;
    for (int axis = 0; axis < 3; ++axis) {
        if (ball.center[axis] - ball.radius - spec.box.min[axis] < tolerance) {
            normals.emplace_back(Vec3::Unit(axis));
        }
        if (axis < 2 && spec.box.max[axis] - ball.radius - ball.center[axis] < tolerance) {
            normals.emplace_back(-Vec3::Unit(axis));
        }
    }
    for (const Ball& other : balls) {
        const Vec3 apart = ball.center - other.center;
        if (apart.norm() > 0.0 && apart.norm() < ball.radius + other.radius + tolerance) {
            normals.push_back(apart.normalized());
        }
    }
    return normals;
}

/// Whether pushes along the normals can carry a weight: the least squares fit of +z with pushes that do not
/// pull.
bool carried(const std::vector<Vec3>& normals) {
    Vec3 missing = Vec3::UnitZ();
    std::vector<double> push(normals.size(), 0.0);
    for (int pass = 0; pass < 20000; ++pass) {
        for (std::size_t k = 0; k < normals.size(); ++k) {
            const double wanted = std::max(0.0, push[k] + normals[k].dot(missing));
            missing -= (wanted - push[k]) * normals[k];
            push[k] = wanted;
        }
    }
    return missing.norm() < 0.05;
}

double percentile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size()))];
}

TEST(Powder, packing_is_met_exactly_and_all_balls_stay_in_the_box) {
    for (const double packing : {0.2, 0.4, 0.5, 0.55}) {
        PowderSpec spec = bed_spec();
        spec.packing = packing;
        const std::vector<Ball> balls = pack_powder(spec);
        EXPECT_NEAR(total_volume(balls) / (spec.box.max - spec.box.min).prod(), packing, 1e-3 * packing);
        for (const Ball& ball : balls) {
            const double slack = 1e-9 * spec.d50;
            EXPECT_TRUE(((ball.center - spec.box.min).array() >= ball.radius - slack).all());
            EXPECT_TRUE(((spec.box.max - ball.center).array() >= ball.radius - slack).all());
        }
    }
}

TEST(Powder, balls_overlap_by_no_more_than_one_per_cent_of_the_smaller_diameter) {
    for (const double packing : {0.3, 0.55}) {
        PowderSpec spec = bed_spec();
        spec.packing = packing;
        const std::vector<Ball> balls = pack_powder(spec);
        EXPECT_LE(worst_overlap(balls, balls), 0.01);
    }
}

TEST(Powder, every_ball_is_carried_by_the_floor_or_by_what_it_touches) {
    for (const double packing : {0.25, 0.5}) {
        PowderSpec spec = bed_spec();
        spec.packing = packing;
        const std::vector<Ball> balls = pack_powder(spec);
        std::size_t floating = 0;
        for (const Ball& ball : balls) {
            const std::vector<Vec3> normals = contact_normals(spec, balls, ball);
            const bool on_floor = ball.center.z() - ball.radius < spec.box.min.z() + 5e-3 * spec.d50;
            floating += on_floor || (normals.size() >= 3 && carried(normals)) ? 0 : 1;
        }
        EXPECT_EQ(floating, 0u) << "of " << balls.size();
    }
}

TEST(Powder, diameters_have_the_percentiles_asked_for) {
    PowderSpec spec = bed_spec();
    for (const std::size_t count : {std::size_t{100}, std::size_t{5000}}) {
        const double tolerance = count == 100 ? 0.03 : 0.005;
        const std::vector<double> diameters = draw_diameters(spec, count);
        EXPECT_NEAR(percentile(diameters, 0.1), spec.d10, tolerance * spec.d10);
        EXPECT_NEAR(percentile(diameters, 0.5), spec.d50, tolerance * spec.d50);
        EXPECT_NEAR(percentile(diameters, 0.9), spec.d90, tolerance * spec.d90);
    }
}

TEST(Powder, percentiles_by_volume_weigh_balls_by_their_volume) {
    PowderSpec spec = bed_spec();
    spec.basis = PercentileBasis::volume;
    std::vector<double> diameters = draw_diameters(spec, 20000);
    std::sort(diameters.begin(), diameters.end());
    double all = 0.0;
    for (const double d : diameters) {
        all += d * d * d;
    }
    double sum = 0.0;
    std::vector<double> found;
    for (const double d : diameters) {
        const double before = sum / all;
        sum += d * d * d;
        for (const double share : {0.1, 0.5, 0.9}) {
            if (before < share && sum / all >= share) {
                found.push_back(d);
            }
        }
    }
    ASSERT_EQ(found.size(), 3u);
    EXPECT_NEAR(found[0], spec.d10, 0.01 * spec.d10);
    EXPECT_NEAR(found[1], spec.d50, 0.01 * spec.d50);
    EXPECT_NEAR(found[2], spec.d90, 0.01 * spec.d90);
}

TEST(Powder, packed_bed_keeps_the_percentiles) {
    PowderSpec spec = bed_spec();
    std::vector<double> diameters;
    for (const Ball& ball : pack_powder(spec)) {
        diameters.push_back(2.0 * ball.radius);
    }
    EXPECT_NEAR(percentile(diameters, 0.1), spec.d10, 0.03 * spec.d10);
    EXPECT_NEAR(percentile(diameters, 0.5), spec.d50, 0.03 * spec.d50);
    EXPECT_NEAR(percentile(diameters, 0.9), spec.d90, 0.03 * spec.d90);
}

TEST(Powder, same_seed_gives_the_same_bed_and_another_seed_another) {
    const auto same = [](const std::vector<Ball>& a, const std::vector<Ball>& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Ball& x, const Ball& y) {
            return x.center == y.center && x.radius == y.radius;
        });
    };
    PowderSpec spec = bed_spec();
    spec.packing = 0.4;
    const std::vector<Ball> balls = pack_powder(spec);
    EXPECT_TRUE(same(balls, pack_powder(spec)));
    spec.seed = 8;
    EXPECT_FALSE(same(balls, pack_powder(spec)));
}

TEST(Powder, second_layer_lies_on_the_balls_of_the_first) {
    PowderSpec spec = bed_spec();
    spec.packing = 0.3;
    PowderGround ground;
    ground.balls = pack_powder(spec);
    PowderSpec upper = spec;
    upper.box.max.z() += 60 * um;
    upper.seed = 11;
    const std::vector<Ball> balls = pack_powder(upper, ground);
    EXPECT_LE(worst_overlap(balls, ground.balls), 0.01);
    std::vector<Ball> all = ground.balls;
    all.insert(all.end(), balls.begin(), balls.end());
    for (const Ball& ball : balls) {
        EXPECT_TRUE(carried(contact_normals(upper, all, ball)));
    }
    const double free = (upper.box.max - upper.box.min).prod() - total_volume(ground.balls);
    EXPECT_NEAR(total_volume(balls) / free, spec.packing, 0.01);
}

TEST(Powder, powder_lies_on_a_surface_given_by_its_distance) {
    PowderSpec spec = bed_spec();
    spec.packing = 0.35;
    const Ball hump{Vec3(100 * um, 200 * um, 0.0), 80 * um};
    PowderGround ground;
    ground.distance = [&](const Vec3& place) { return (place - hump.center).norm() - hump.radius; };
    const std::vector<Ball> balls = pack_powder(spec, ground);
    EXPECT_LE(worst_overlap(balls, {hump}), 0.011);
    std::vector<Ball> all = balls;
    all.push_back(hump);
    std::size_t on_hump = 0;
    for (const Ball& ball : balls) {
        EXPECT_TRUE(carried(contact_normals(spec, all, ball)));
        const double gap = ground.distance(ball.center) - ball.radius;
        on_hump += gap < 5e-3 * spec.d50 ? 1 : 0;
    }
    EXPECT_GT(on_hump, 3u);
}

TEST(Powder, packing_out_of_reach_is_refused_with_one_that_can_be_made) {
    PowderSpec spec = bed_spec();
    spec.packing = 0.7;
    try {
        pack_powder(spec);
        FAIL();
    } catch (const GeometryError& error) {
        const std::string message = error.what();
        const std::size_t at = message.find("; 0.");
        ASSERT_NE(at, std::string::npos) << message;
        spec.packing = std::stod(message.substr(at + 2));
        EXPECT_GT(spec.packing, 0.5);
        EXPECT_NO_THROW(pack_powder(spec));
    }
}

TEST(Powder, layer_hardly_thicker_than_its_balls_can_be_packed) {
    PowderSpec spec = bed_spec();
    spec.box.max.z() = spec.box.min.z() + 45 * um;
    spec.packing = 0.35;
    const std::vector<Ball> balls = pack_powder(spec);
    EXPECT_LE(worst_overlap(balls, balls), 0.01);
}

TEST(Powder, meaningless_numbers_are_refused) {
    const auto refused = [](auto change) {
        PowderSpec spec = bed_spec();
        change(spec);
        EXPECT_THROW(pack_powder(spec), GeometryError);
    };
    refused([](PowderSpec& spec) { spec.packing = 0.0; });
    refused([](PowderSpec& spec) { spec.packing = 1.0; });
    refused([](PowderSpec& spec) { spec.packing = std::nan(""); });
    refused([](PowderSpec& spec) { spec.d10 = 0.0; });
    refused([](PowderSpec& spec) { spec.d10 = 31 * um; });
    refused([](PowderSpec& spec) { spec.d90 = HUGE_VAL; });
    refused([](PowderSpec& spec) { spec.d90 = 1e-3; });
    refused([](PowderSpec& spec) { spec.d10 = spec.d50 = spec.d90 = 1e-9; });
    refused([](PowderSpec& spec) { spec.box.max.z() = spec.box.min.z(); });
}

} // namespace
} // namespace meltscope
