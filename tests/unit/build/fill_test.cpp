#include "meltscope/build/fill.hpp"

#include "mesh_samples.hpp"

#include "meltscope/constants.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <limits>

namespace meltscope {
namespace {

/// Particle sites of a block of cells of 10 um, 8 a cell.
Lattice cell_lattice(std::int64_t nx, std::int64_t ny, std::int64_t nz) {
    Lattice lattice;
    lattice.spacing = 5e-6;
    lattice.origin = Vec3(-100e-6, 20e-6, -50e-6) + Vec3::Constant(2.5e-6);
    lattice.count = {nx, ny, nz};
    return lattice;
}

Vec3 site(const Lattice& lattice, std::int64_t i, std::int64_t j, std::int64_t k) {
    return lattice.origin +
           lattice.spacing * Vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
}

std::int64_t count_of(const std::vector<std::int16_t>& sites, std::int16_t body) {
    return std::count(sites.begin(), sites.end(), body);
}

/// What fill is meant to give, asked site by site.
void expect_like_contains(const std::vector<Shape>& bodies, const Lattice& lattice) {
    const std::vector<std::int16_t> sites = fill(bodies, lattice);
    std::size_t n = 0;
    std::size_t wrong = 0;
    for (std::int64_t k = 0; k < lattice.count.z(); ++k) {
        for (std::int64_t j = 0; j < lattice.count.y(); ++j) {
            for (std::int64_t i = 0; i < lattice.count.x(); ++i, ++n) {
                const Vec3 place = site(lattice, i, j, k) + Vec3::Constant(1e-9 * lattice.spacing);
                std::int16_t body = -1;
                for (std::size_t b = 0; b < bodies.size(); ++b) {
                    body = contains(bodies[b], place) ? static_cast<std::int16_t>(b) : body;
                }
                wrong += sites[n] != body ? 1 : 0;
            }
        }
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(count_of(sites, static_cast<std::int16_t>(bodies.size() - 1)), 0);
}

TEST(Fill, box_holds_exactly_the_sites_of_its_cells) {
    const Lattice lattice = cell_lattice(40, 20, 10);
    const std::vector<Shape> bodies{Box{Vec3(-50e-6, 40e-6, -30e-6), Vec3(20e-6, 70e-6, -10e-6)}};
    EXPECT_EQ(count_of(fill(bodies, lattice), 0), 14 * 6 * 4);
}

TEST(Fill, abutting_boxes_share_and_miss_no_site_even_where_faces_run_through_sites) {
    Lattice lattice = cell_lattice(40, 20, 10);
    for (const double shift : {0.0, 2.5e-6, 1e-22, -1e-22, 0.7e-6}) {
        const double x = -100e-6 + 52.5e-6 + shift; // for some shifts on a plane of sites, up to rounding
        const double z = -50e-6 + 22.5e-6 + shift;
        const std::vector<Shape> bodies{Box{Vec3(-1e-3, -1e-3, -1e-3), Vec3(x, 1e-3, 1e-3)},
                                        Box{Vec3(x, -1e-3, -1e-3), Vec3(1e-3, 1e-3, z)},
                                        Box{Vec3(x, -1e-3, z), Vec3(1e-3, 1e-3, 1e-3)}};
        const auto sites = fill(bodies, lattice);
        EXPECT_EQ(count_of(sites, -1), 0);
        std::int64_t sum = 0;
        for (std::int16_t b = 0; b < 3; ++b) { // each alone holds what it holds beside the others
            const std::vector<Shape> alone{bodies[static_cast<std::size_t>(b)]};
            sum += count_of(fill(alone, lattice), 0);
        }
        EXPECT_EQ(sum, 40 * 20 * 10) << shift;
    }
}

TEST(Fill, rounding_of_a_face_on_a_plane_of_sites_does_not_matter) {
    const Lattice lattice = cell_lattice(40, 20, 10);
    const double x = site(lattice, 7, 0, 0).x();
    const auto filled_below = [&](double face) {
        const std::vector<Shape> bodies{Box{Vec3(-1, -1, -1), Vec3(face, 1, 1)}};
        return count_of(fill(bodies, lattice), 0);
    };
    const double few_ulps = 1e-10 * lattice.spacing;
    EXPECT_EQ(filled_below(x), 7 * 20 * 10);
    EXPECT_EQ(filled_below(x + few_ulps), 7 * 20 * 10);
    EXPECT_EQ(filled_below(x - few_ulps), 7 * 20 * 10);
    EXPECT_EQ(filled_below(x + 1e-6 * lattice.spacing), 8 * 20 * 10);
}

TEST(Fill, later_body_replaces_an_earlier_one) {
    const Lattice lattice = cell_lattice(20, 20, 20);
    const Box all{Vec3(-1, -1, -1), Vec3(1, 1, 1)};
    const Sphere ball{Vec3(-50e-6, 70e-6, 0.0), 30e-6};
    const auto inside = fill(std::vector<Shape>{all, ball}, lattice);
    EXPECT_GT(count_of(inside, 1), 0);
    EXPECT_EQ(count_of(inside, -1), 0);
    EXPECT_EQ(count_of(fill(std::vector<Shape>{ball, all}, lattice), 1), 20 * 20 * 20);
}

TEST(Fill, every_shape_agrees_with_contains) {
    const Lattice lattice = cell_lattice(36, 30, 24);
    const Vec3 middle = site(lattice, 17, 15, 12) + Vec3(0.3e-6, -0.7e-6, 1.1e-6);
    Balls balls;
    for (int i = 0; i < 9; ++i) {
        balls.balls.push_back(
            {middle + Vec3(10.3e-6 * (i - 4), 7e-6 * ((i % 3) - 1), 13e-6 * ((i % 4) - 1.5)),
             (6.0 + i) * 1e-6});
    }
    expect_like_contains({Box{middle - Vec3::Constant(20e-6), middle + Vec3::Constant(31e-6)}}, lattice);
    expect_like_contains({Sphere{middle, 44e-6}}, lattice);
    for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(2, 0, 0), Vec3(0, -1, 0), Vec3(1, 2, 3), Vec3(1, 1e-8, 0)}) {
        const Cylinder cylinder{middle - 20e-6 * axis.normalized(), axis, 25e-6, 50e-6};
        expect_like_contains({cylinder}, lattice);
    }
    expect_like_contains({balls}, lattice);
    expect_like_contains({ball_mesh(middle, 44e-6, 2)}, lattice);
    expect_like_contains(
        {Box{middle - Vec3::Constant(1), middle}, Sphere{middle, 44e-6}, balls, ball_mesh(middle, 20e-6, 1)},
        lattice);
}

TEST(Fill, filled_volume_converges_to_the_shapes_volume) {
    const Lattice lattice = cell_lattice(60, 60, 60);
    const double site_volume = 125e-18;
    const Vec3 middle = site(lattice, 30, 30, 30) + Vec3(1e-6, 2e-6, -1e-6);
    const double r = 120e-6;
    const auto filled = [&](const Shape& shape) {
        return static_cast<double>(count_of(fill(std::vector<Shape>{shape}, lattice), 0)) * site_volume;
    };
    const double ball = 4.0 / 3.0 * constants::pi * r * r * r;
    EXPECT_NEAR(filled(Sphere{middle, r}), ball, 2e-3 * ball);
    const Vec3 axis = Vec3(1, -2, 0.5).normalized();
    const double cylinder = constants::pi * 60e-6 * 60e-6 * 150e-6;
    EXPECT_NEAR(filled(Cylinder{middle - 75e-6 * axis, axis, 60e-6, 150e-6}), cylinder, 1e-2 * cylinder);
}

TEST(Fill, mesh_of_a_block_fills_like_the_box_even_where_faces_run_through_sites) {
    const Lattice lattice = cell_lattice(40, 20, 10);
    for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(2.5e-6, 2.5e-6, 2.5e-6), Vec3(1e-7, -3e-7, 2e-7)}) {
        const Vec3 min = Vec3(-50e-6, 40e-6, -30e-6) + shift;
        const Vec3 max = Vec3(20e-6, 70e-6, -10e-6) + shift;
        EXPECT_EQ(fill(std::vector<Shape>{block_mesh(min, max)}, lattice),
                  fill(std::vector<Shape>{Box{min, max}}, lattice));
    }
}

TEST(Fill, hollow_mesh_stays_hollow_and_overlapping_shells_do_not_cancel) {
    const Lattice lattice = cell_lattice(40, 40, 40);
    const Vec3 middle = site(lattice, 20, 20, 20);
    Solid both = block_mesh(middle - Vec3::Constant(60e-6), middle + Vec3::Constant(60e-6));
    Solid inner = block_mesh(middle - Vec3::Constant(30e-6), middle + Vec3::Constant(30e-6));
    const auto offset = static_cast<std::uint32_t>(both.points.size());
    both.points.insert(both.points.end(), inner.points.begin(), inner.points.end());
    Solid hollow = both;
    for (const auto& [a, b, c] : inner.triangles) {
        both.triangles.push_back({a + offset, b + offset, c + offset});
        hollow.triangles.push_back({a + offset, c + offset, b + offset}); // faces into the hole
    }
    EXPECT_EQ(count_of(fill(std::vector<Shape>{both}, lattice), 0), 24 * 24 * 24);
    EXPECT_EQ(count_of(fill(std::vector<Shape>{hollow}, lattice), 0), 24 * 24 * 24 - 12 * 12 * 12);
}

TEST(Fill, result_does_not_depend_on_the_number_of_threads) {
    const Lattice lattice = cell_lattice(50, 50, 50);
    const std::vector<Shape> bodies{Sphere{site(lattice, 25, 25, 25), 100e-6},
                                    ball_mesh(site(lattice, 10, 20, 30), 70e-6, 2)};
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const auto one = fill(bodies, lattice);
    omp_set_num_threads(4);
    EXPECT_EQ(fill(bodies, lattice), one);
    omp_set_num_threads(threads);
}

TEST(Fill, layers_taken_singly_make_the_whole) {
    const Lattice lattice = cell_lattice(13, 11, 9);
    const std::vector<Shape> bodies{Sphere{site(lattice, 6, 5, 4), 20e-6}};
    const auto whole = fill(bodies, lattice);
    const LatticeFill filler(bodies, lattice);
    std::vector<std::int16_t> layer(13 * 11);
    for (std::int64_t k = 0; k < 9; ++k) {
        filler.layer(k, layer);
        EXPECT_TRUE(std::equal(layer.begin(), layer.end(), whole.begin() + k * 13 * 11));
    }
}

TEST(Fill, bounding_boxes_are_tight) {
    const Cylinder slanted{Vec3(1, 2, 3), Vec3(3, 0, 4), 0.5, 10.0};
    const Box box = bounding_box(slanted);
    EXPECT_LT((box.min - Vec3(1 - 0.4, 1.5, 3 - 0.3)).norm(), 1e-14);
    EXPECT_LT((box.max - Vec3(7.4, 2.5, 11.3)).norm(), 1e-14);
    EXPECT_EQ(bounding_box(Balls{{{Vec3(0, 0, 0), 1.0}, {Vec3(5, 0, 0), 2.0}}}).max, Vec3(7, 2, 2));
}

TEST(Fill, shapes_without_size_are_refused) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(check_shape(Box{Vec3(0, 0, 0), Vec3(1, 0, 1)}), GeometryError);
    EXPECT_THROW(check_shape(Sphere{Vec3(nan, 0, 0), 1.0}), GeometryError);
    EXPECT_THROW(check_shape(Sphere{Vec3::Zero(), -1.0}), GeometryError);
    EXPECT_THROW(check_shape(Cylinder{Vec3::Zero(), Vec3::Zero(), 1.0, 1.0}), GeometryError);
    EXPECT_THROW(check_shape(Solid{{}, {{0, 1, 2}}}), GeometryError);
    Lattice lattice;
    EXPECT_THROW(fill(std::vector<Shape>{}, lattice), GeometryError);
}

} // namespace
} // namespace meltscope
