#include "reference/conduction.hpp"
#include "reference/driver.hpp"
#include "reference/table.hpp"

#include <gtest/gtest.h>

namespace meltscope::verification {
namespace {

constexpr double left_start = 1500.0, right_start = 500.0; // K

struct Slab {
    double conductivity, density, heat_capacity;
    double diffusivity() const { return conductivity / (density * heat_capacity); }
    double effusivity() const { return std::sqrt(conductivity * density * heat_capacity); }
};

struct Result {
    double contact = 0.0; ///< error of the contact temperature by the difference of the slabs
    double profile = 0.0; ///< largest error of the profile, likewise
};

/// Two slabs meet `shift` cells right of the middle of a bar, at a plane of nodes if that is whole.
Result join(const Slab& left, const Slab& right, int cells, double shift, ResultTable* profile = nullptr) {
    const double dx = 1.0 / cells, contact = 0.5 + shift * dx;
    const Grid grid = make_grid(Vec3::Zero(), dx, {cells, 1, 1});
    std::vector<EquationOfState> materials;
    for (const Slab& s : {left, right})
        materials.push_back(
            make_equation_of_state(constant_material(s.conductivity, s.density, s.heat_capacity)));
    ParticleList list = lattice_points(grid, 2, everywhere);
    for (std::int64_t q = 0; q < list.size(); ++q)
        list.material[q] = list.position[q][0] < contact ? 0 : 1;
    set_state(
        materials, [=](const Vec3& x) { return x[0] < contact ? left_start : right_start; }, list);
    ThermalRun run(grid, materials, Boundary{}, std::move(list), 2);
    const double alpha = std::max(left.diffusivity(), right.diffusivity());
    const double t = 0.02 / alpha;
    run.advance(t, alpha);
    EXPECT_NEAR(total_energy(run.particles) / run.start_energy, 1.0, 1e-13);

    const double exact_contact =
        contact_temperature(left.effusivity(), left_start, right.effusivity(), right_start);
    Result result;
    result.contact = std::abs(run.temperature(Vec3(contact, 0.5 * dx, 0.5 * dx)) - exact_contact) /
                     (left_start - right_start);
    for (int i = 0; i <= 2 * cells; ++i) {
        const double x = 0.5 * i * dx;
        const Slab& slab = x < contact ? left : right;
        const double start = x < contact ? left_start : right_start;
        const double exact =
            start + (exact_contact - start) * step_profile(std::abs(x - contact), slab.diffusivity(), t);
        const double got = run.temperature(Vec3(x, 0.5 * dx, 0.5 * dx));
        result.profile = std::max(result.profile, std::abs(got - exact) / (left_start - right_start));
        if (profile)
            profile->row({x, exact, got});
    }
    return result;
}

TEST(TwoSlabs, contact_temperature_is_that_of_the_effusivities) {
    ResultTable table("two_slabs", "pair,cells,shift_cells,contact_percent,profile_percent");
    ResultTable profile("two_slabs_profile", "x,exact,computed");
    struct Pair {
        const char* name;
        Slab left, right;
    };
    for (const Pair& pair : {Pair{"conductivity 1 : 4", {1.0, 1.0, 1.0}, {4.0, 1.0, 1.0}},
                             Pair{"heat capacity 1 : 3", {1.0, 1.0, 1.0}, {1.0, 1.0, 3.0}},
                             Pair{"all three", {1.0, 2.0, 1.5}, {3.0, 1.0, 0.8}}})
        for (const int cells : {80, 160})
            for (const double shift : {0.0, 0.5}) {
                const bool shown = cells == 80 && shift == 0.0 && pair.left.density == 2.0;
                const Result r = join(pair.left, pair.right, cells, shift, shown ? &profile : nullptr);
                table.row(pair.name, {double(cells), shift, 100.0 * r.contact, 100.0 * r.profile});
                EXPECT_LT(r.contact, 0.02) << pair.name << ", " << cells << " cells, shift " << shift;
                EXPECT_LT(r.profile, 0.02) << pair.name << ", " << cells << " cells, shift " << shift;
            }
}

} // namespace
} // namespace meltscope::verification
