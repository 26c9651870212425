#include "meltscope/scenario/nearest_word.hpp"

#include <gtest/gtest.h>

namespace meltscope {
namespace {

const std::vector<std::string> keys{"power", "path", "absorptivity", "spot_radius", "on"};

TEST(nearest_word, slips_of_the_finger_find_the_word) {
    EXPECT_EQ(nearest_word("powr", keys), "power");
    EXPECT_EQ(nearest_word("pwoer", keys), "power");
    EXPECT_EQ(nearest_word("Power", keys), "power");
    EXPECT_EQ(nearest_word("absorbtivity", keys), "absorptivity");
    EXPECT_EQ(nearest_word("spotradius", keys), "spot_radius");
    EXPECT_EQ(nearest_word("no", keys), "on");
}

TEST(nearest_word, the_beginning_of_a_word_finds_it) {
    EXPECT_EQ(nearest_word("abs", keys), "absorptivity");
}

TEST(nearest_word, strange_words_find_nothing) {
    EXPECT_EQ(nearest_word("temperature", keys), "");
    EXPECT_EQ(nearest_word("xy", keys), "");
    EXPECT_EQ(nearest_word("", keys), "");
    EXPECT_EQ(nearest_word(std::string(100000, 'p'), keys), "");
    EXPECT_EQ(nearest_word("power", {}), "");
}

} // namespace
} // namespace meltscope
