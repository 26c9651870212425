#include "reference/shapes.hpp"
#include "reference/table.hpp"

#include "meltscope/mpm/free_surface.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

void compare(ResultTable& table, const ExactShape& shape, int n, bool jittered) {
    const SampledShape sampled = sample_shape(shape, n, jittered);
    const Field phi = signed_distance(sampled.grid, sampled.particles, {});
    const DistanceError error = distance_error(shape, sampled.grid, phi);
    const std::string where =
        shape.name + ", " + std::to_string(n * n * n) + " a cell" + (jittered ? ", jittered" : "");
    table.row(shape.name, {double(n * n * n), jittered ? 1.0 : 0.0, error.most, error.rms, error.gradient,
                           error.gradient_rms});
    // moved particles leave the surface itself uneven
    EXPECT_LE(error.most, jittered ? 0.5 : 0.25) << where;
    EXPECT_LE(error.gradient_rms, 0.05) << where;
}

constexpr const char* header =
    "shape,particles_in_cell,jittered,max_error_cells,rms_error_cells,max_gradient_error,rms_gradient_error";

TEST(LevelSet, distances_within_a_quarter_cell_near_the_surface) {
    ResultTable table("level_set", header);
    for (const int n : {2, 3})
        for (const bool jittered : {false, true})
            for (const ExactShape& shape :
                 {sphere(10.0), plane(0.0), plane(0.0, 0.37), plane(17.0), plane(30.0), plane(45.0, 0.25),
                  torus(9.0, 4.0), touching_spheres(8.0)})
                compare(table, shape, n, jittered);
}

TEST(LevelSet, error_on_a_sphere_by_its_radius) {
    ResultTable table("level_set_radius",
                      "radius_cells,max_error_cells,rms_error_cells,max_error_by_radius,max_gradient_error");
    double smaller = 1.0;
    for (const double radius : {4.0, 8.0, 16.0}) {
        const ExactShape shape = sphere(radius);
        const SampledShape sampled = sample_shape(shape, 2, false);
        const DistanceError error =
            distance_error(shape, sampled.grid, signed_distance(sampled.grid, sampled.particles, {}));
        table.row({radius, error.most, error.rms, error.most / radius, error.gradient});
        EXPECT_LT(error.rms / radius, 0.75 * smaller)
            << "at least first order in the cell size, radius " << radius;
        smaller = error.rms / radius;
    }
}

TEST(LevelSet, areas_within_3_percent) {
    ResultTable table("level_set_area", "shape,particles_in_cell,jittered,area_error_percent");
    for (const int n : {2, 3})
        for (const bool jittered : {false, true})
            for (const ExactShape& shape : {plane(0.0), plane(0.0, 0.37), plane(17.0), plane(30.0),
                                            plane(45.0, 0.25), sphere(4.0), sphere(10.0)}) {
                const SampledShape sampled = sample_shape(shape, n, jittered);
                const Nodes nodes = make_nodes(sampled.grid, sampled.particles, 1, Boundary{});
                const FreeSurface surface =
                    find_free_surface(sampled.grid, sampled.particles, nodes, {}, true);
                double area = 0.0;
                for (std::int64_t e = 0; e < surface.elements.count(); ++e)
                    area += surface.elements.area[e] * shape.window(surface.elements.point[e]);
                table.row(shape.name,
                          {double(n * n * n), jittered ? 1.0 : 0.0, 100.0 * (area / shape.area - 1.0)});
                EXPECT_NEAR(area / shape.area, 1.0, 0.03) << shape.name << ", " << n << ", " << jittered;
            }
}

} // namespace
} // namespace meltscope::verification
