#include "example.hpp"

#include <random>

/// Whatever is fed in, the answer is a Scenario or a ScenarioError: no crash, no other exception.
namespace meltscope {
namespace {

using test::complaint;
using test::example;
using test::with;

std::string repeated(const std::string& part, int count) {
    std::string result;
    for (int i = 0; i < count; ++i) {
        result += part;
    }
    return result;
}

TEST(scenario_robustness, deep_nesting_is_refused) {
    EXPECT_NE(complaint("title = " + repeated("[", 1000000)).find("nested more than 32 deep"),
              std::string::npos);
    EXPECT_NE(complaint("title = " + repeated("{a=", 1000000)).find("nested more than 32 deep"),
              std::string::npos);
    EXPECT_NE(complaint("a" + repeated(".a", 1000000) + " = 1").find("nested more than 32 deep"),
              std::string::npos);
    EXPECT_NE(complaint("[a" + repeated(".\"a\"", 1000000) + "]").find("nested more than 32 deep"),
              std::string::npos);
    EXPECT_NE(complaint("a" + repeated(".a", 1000000)).find("nested more than 32 deep"), std::string::npos);
}

TEST(scenario_robustness, dots_and_brackets_in_text_and_comments_are_no_nesting) {
    const std::string many = repeated(".", 500) + repeated("[", 500);
    EXPECT_EQ(complaint("# " + many + "\n" + example), "");
    EXPECT_EQ(complaint(with("\"example\"", "\"" + many + "\\\"" + many + "\"")), "");
    EXPECT_EQ(complaint(with("\"example\"", "'" + many + "'")), "");
    EXPECT_EQ(complaint(with("\"example\"", "\"\"\"\n" + many + "\"" + many + "\"\"\"")), "");
}

TEST(scenario_robustness, strange_bytes_are_refused) {
    EXPECT_NE(complaint(std::string("title = \"\xff\xfe\"")), "");
    EXPECT_NE(complaint(std::string("title = \"a\0b\"", 13)), "");
    EXPECT_NE(complaint(std::string(1000, '\0')), "");
    EXPECT_NE(complaint("\xef\xbb\xbf"), "");
    EXPECT_NE(complaint(repeated("\xc3", 1000)), "");
}

TEST(scenario_robustness, huge_numbers_are_refused_or_taken_but_never_overflow) {
    for (const std::string number :
         {"1e308", "-1e308", "1e-320", "9223372036854775807", "-9223372036854775808", "99999999999999999999",
          "1e999", "nan", "-inf", "\"1e308 Pm\"", "0x7fffffffffffffff"}) {
        for (const char* line :
             {"cell_size = \"10 um\"", "max = [\"400 um\", \"200 um\", \"20 um\"]", "density = 8000",
              "solidus = 1650", "latent_heat = 2.7e5", "solid = [20]", "power = \"100 W\"",
              "spot_radius = \"50 um\"", "speed = \"0.5 m/s\"", "end = \"1 ms\"", "every = \"50 us\"",
              "keep = 3", "radiation = false", "views = [\"overview\"]"}) {
            const std::string text(line);
            const std::string key = text.substr(0, text.find('='));
            complaint(with(text, key + "= " + number));
            complaint(with(text, key + "= [" + number + ", " + number + ", " + number + "]"));
        }
    }
}

TEST(scenario_robustness, each_line_left_out_or_doubled_gives_an_answer) {
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < example.size();) {
        const auto end = example.find('\n', at);
        lines.push_back(example.substr(at, end - at + 1));
        at = end + 1;
    }
    for (std::size_t i = 0; i < lines.size(); ++i) {
        std::string without;
        std::string doubled;
        for (std::size_t k = 0; k < lines.size(); ++k) {
            without += k == i ? "" : lines[k];
            doubled += k == i ? lines[k] + lines[k] : lines[k];
        }
        complaint(without);
        complaint(doubled);
    }
}

TEST(scenario_robustness, random_damage_gives_an_answer) {
    const std::string alphabet = "[]{}=.,\"'#\n\\ 019eE+-_xinfatruo\xc2\xb5\x00";
    std::mt19937_64 random(7);
    for (int round = 0; round < 400; ++round) {
        std::string text = example;
        const std::size_t wounds = 1 + random() % 4;
        for (std::size_t i = 0; i < wounds; ++i) {
            const std::size_t at = random() % text.size();
            switch (random() % 4) {
            case 0:
                text[at] = alphabet[random() % alphabet.size()];
                break;
            case 1:
                text.erase(at, 1 + random() % 8);
                break;
            case 2:
                text.insert(at, 1, alphabet[random() % alphabet.size()]);
                break;
            default:
                text.insert(at, text.substr(random() % text.size(), random() % 40));
            }
        }
        complaint(text); // anything but a ScenarioError would fail the test
    }
}

} // namespace
} // namespace meltscope
