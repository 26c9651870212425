#include "meltscope/material/equation_of_state.hpp"

#include "meltscope/scenario/scenario_file.hpp"

#include <gtest/gtest.h>

namespace meltscope {
namespace {

const std::vector<std::string> alloys{"in625", "in718", "ss316l", "ti6al4v"};

Material material(const std::string& name) {
    return read_material(MELTSCOPE_SOURCE_DIR "/scenarios/materials/" + name + ".toml");
}

TEST(EquationOfState, temperature_is_the_inverse_of_energy) {
    for (const std::string& name : alloys) {
        const EquationOfState eos = make_equation_of_state(material(name));
        for (double t = 200.0; t <= 4500.0; t += 0.37)
            ASSERT_NEAR(eos.temperature(eos.energy(t)), t, 0.01) << name;
        for (const double t : {eos.solidus, eos.liquidus})
            EXPECT_NEAR(eos.temperature(eos.energy(t)), t, 1e-6) << name;
    }
}

TEST(EquationOfState, energy_and_temperature_rise_together) {
    for (const std::string& name : alloys) {
        const EquationOfState eos = make_equation_of_state(material(name));
        double energy = eos.energy(200.0), temperature = 0.0;
        for (double t = 200.37; t <= 4500.0; t += 0.37) {
            const double next = eos.energy(t);
            ASSERT_GT(next, energy) << name << " at " << t << " K";
            ASSERT_GT(eos.temperature(next), temperature) << name << " at " << t << " K";
            energy = next;
            temperature = eos.temperature(next);
        }
    }
}

TEST(EquationOfState, lanes_give_what_doubles_give) {
    for (const std::string& name : alloys) {
        const EquationOfState eos = make_equation_of_state(material(name));
        for (double t = 250.0; t < 4000.0; t += 11.3) {
            const Lanes lanes([=](int lane) { return t + 97.0 * lane; });
            const Lanes energy = eos.energy(lanes), temperature = eos.temperature(energy);
            const Lanes kappa = eos.conductivity(lanes), c = eos.heat_capacity(lanes);
            for (int lane = 0; lane < lane_count; ++lane) {
                const double alone = lanes[lane];
                // fused and separate multiply-adds may differ in the last bits
                EXPECT_DOUBLE_EQ(energy[lane], eos.energy(alone));
                EXPECT_NEAR(temperature[lane], eos.temperature(eos.energy(alone)), 1e-9);
                EXPECT_DOUBLE_EQ(kappa[lane], eos.conductivity(alone));
                EXPECT_DOUBLE_EQ(c[lane], eos.heat_capacity(alone));
            }
        }
    }
}

TEST(EquationOfState, heat_capacity_is_the_slope_of_the_energy) {
    for (const std::string& name : alloys) {
        const EquationOfState eos = make_equation_of_state(material(name));
        const double h = 0.01;
        for (double t = 300.0; t < 4400.0; t += 3.1) {
            if (std::abs(t - eos.solidus) < 2.0 * h || std::abs(t - eos.liquidus) < 2.0 * h)
                continue;
            const double slope = (eos.energy(t + h) - eos.energy(t - h)) / (2.0 * h);
            ASSERT_NEAR(eos.heat_capacity(t) / slope, 1.0, 1e-6) << name << " at " << t << " K";
        }
    }
}

TEST(EquationOfState, latent_heat_adds_up) {
    for (const std::string& name : alloys) {
        const Material with = material(name);
        Material without = with;
        without.latent_heat = 0.0;
        const EquationOfState melting = make_equation_of_state(with),
                              warming = make_equation_of_state(without);
        EXPECT_NEAR(melting.energy(with.solidus - 1.0), warming.energy(with.solidus - 1.0), 1e-6) << name;
        for (const double t : {with.liquidus, 3000.0})
            EXPECT_NEAR((melting.energy(t) - warming.energy(t)) / with.latent_heat, 1.0, 1e-9) << name;
        const double middle = 0.5 * (with.solidus + with.liquidus);
        EXPECT_NEAR((melting.energy(middle) - warming.energy(middle)) / with.latent_heat, 0.5, 1e-9) << name;
    }
}

TEST(EquationOfState, mush_is_mixed_by_the_liquid_fraction) {
    for (const std::string& name : alloys) {
        const Material m = material(name);
        const EquationOfState eos = make_equation_of_state(m);
        EXPECT_EQ(eos.liquid_fraction(m.solidus - 1.0), 0.0);
        EXPECT_EQ(eos.liquid_fraction(m.liquidus + 1.0), 1.0);
        for (const double f : {0.0, 0.25, 0.7, 1.0}) {
            const double t = m.solidus + f * (m.liquidus - m.solidus);
            EXPECT_NEAR(eos.liquid_fraction(t), f, 1e-12) << name;
            EXPECT_NEAR(eos.conductivity(t),
                        (1.0 - f) * m.conductivity.solid(t) + f * m.conductivity.liquid(t), 1e-9)
                << name;
        }
    }
}

TEST(EquationOfState, largest_diffusivity_is_met_and_not_exceeded) {
    const EquationOfState eos = make_equation_of_state(material("in625"));
    const double most = max_diffusivity(eos, 300.0, 3000.0);
    double met = 0.0;
    for (double t = 300.0; t <= 3000.0; t += 0.1)
        met = std::max(met, eos.conductivity(t) / (eos.density * eos.heat_capacity(t)));
    EXPECT_NEAR(most / met, 1.0, 1e-3);
}

TEST(EquationOfState, impossible_materials_are_refused) {
    Material m = material("in625");
    m.liquidus = m.solidus;
    EXPECT_THROW(make_equation_of_state(m), std::invalid_argument);
    m = material("in625");
    m.heat_capacity.liquid = {{1000.0, -1.0, 0.0}};
    EXPECT_THROW(make_equation_of_state(m), std::invalid_argument);
}

} // namespace
} // namespace meltscope
