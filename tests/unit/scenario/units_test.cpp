#include "meltscope/scenario/units.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace meltscope {
namespace {

std::string refusal(const std::string& text, const Quantity& quantity) {
    try {
        to_si(text, quantity);
    } catch (const UnitError& error) {
        return error.what();
    }
    return {};
}

TEST(units, prefixed_units_give_the_nearest_double) {
    EXPECT_EQ(to_si("85 um", quantity::length), 85e-6);
    EXPECT_EQ(to_si("85um", quantity::length), 85e-6);
    EXPECT_EQ(to_si("\t85  um ", quantity::length), 85e-6);
    EXPECT_EQ(to_si("85 \u00b5m", quantity::length), 85e-6); // micro sign
    EXPECT_EQ(to_si("85 \u03bcm", quantity::length), 85e-6); // Greek mu
    EXPECT_EQ(to_si("-250 um", quantity::length), -250e-6);
    EXPECT_EQ(to_si("+3 ms", quantity::time), 3e-3);
    EXPECT_EQ(to_si("5 us", quantity::time), 5e-6);
    EXPECT_EQ(to_si("2 ns", quantity::time), 2e-9);
    EXPECT_EQ(to_si("800 mm/s", quantity::speed), 0.8);
    EXPECT_EQ(to_si("0.8 m s-1", quantity::speed), 0.8);
    EXPECT_EQ(to_si("195 W", quantity::power), 195.0);
    EXPECT_EQ(to_si("0.2 kW", quantity::power), 200.0);
    EXPECT_EQ(to_si("100 W/m^2/K", quantity::heat_transfer_coefficient), 100.0);
    EXPECT_EQ(to_si("1e3 W/m^2", quantity::heat_flux), 1000.0);
    EXPECT_EQ(to_si("295.7 J/g", quantity::specific_energy), 295700.0);
}

TEST(units, temperatures_have_an_offset) {
    EXPECT_DOUBLE_EQ(to_si("25 degC", quantity::temperature), 298.15);
    EXPECT_DOUBLE_EQ(to_si("1290 degC", quantity::temperature), 1563.15);
    EXPECT_EQ(to_si("300 K", quantity::temperature), 300.0);
    EXPECT_NEAR(to_si("212 degF", quantity::temperature), 373.15, 1e-9);
}

TEST(units, angles_and_ratios_have_their_own_units) {
    EXPECT_DOUBLE_EQ(to_si("180 deg", quantity::angle), 3.14159265358979323846);
    EXPECT_DOUBLE_EQ(to_si("35 %", quantity::number), 0.35);
    EXPECT_EQ(to_si("0.35", quantity::number), 0.35);
}

TEST(units, a_unit_of_something_else_is_refused) {
    EXPECT_EQ(refusal("5 m", quantity::power), "\"5 m\" is not a power; it is written as \"1.5 W\"");
    EXPECT_EQ(refusal("5 W", quantity::angle), "\"5 W\" is not an angle; it is written as \"1.5 rad\"");
    EXPECT_NE(refusal("3 Hz", quantity::time), ""); // a reciprocal is not meant
    EXPECT_NE(refusal("3 seconds since 1999-01-01", quantity::time), "");
}

TEST(units, what_is_no_quantity_is_refused_with_the_reason) {
    EXPECT_EQ(refusal("5 wats", quantity::power), "\"wats\" is not a unit; a power is written as \"1.5 W\"");
    EXPECT_EQ(refusal("5", quantity::length),
              "\"5\" has no unit; a length is a number in m or text such as \"1.5 m\"");
    EXPECT_NE(refusal("", quantity::length).find("does not begin with a number"), std::string::npos);
    EXPECT_NE(refusal("fast", quantity::speed).find("does not begin with a number"), std::string::npos);
    EXPECT_NE(refusal("1e999 m", quantity::length).find("does not fit"), std::string::npos);
    EXPECT_NE(refusal("1e308 km", quantity::length).find("does not fit"), std::string::npos);
    EXPECT_NE(refusal("nan m", quantity::length).find("not finite"), std::string::npos);
    EXPECT_NE(refusal("inf m", quantity::length).find("not finite"), std::string::npos);
    EXPECT_NE(refusal("0x10 m", quantity::length), "");
    EXPECT_NE(refusal("5 2 mm", quantity::length), "");
    EXPECT_NE(refusal("5 " + std::string(100000, 'm'), quantity::length), "");
    EXPECT_NE(refusal("5 " + std::string(90, '('), quantity::length), "");
}

TEST(units, threads_convert_beside_each_other) {
    std::atomic<int> wrong = 0;
    const auto convert = [&](const std::string& text, const Quantity& quantity, double value) {
        for (int n = 0; n < 2000; ++n)
            wrong += to_si(text, quantity) != value;
    };
    std::vector<std::jthread> threads;
    threads.emplace_back(convert, "85 um", quantity::length, 85e-6);
    threads.emplace_back(convert, "800 mm/s", quantity::speed, 0.8);
    threads.emplace_back(convert, "295.7 J/g", quantity::specific_energy, 295700.0);
    threads.clear();
    EXPECT_EQ(wrong, 0);
}

} // namespace
} // namespace meltscope
