#include "meltscope/scenario/units.hpp"

#include <fmt/format.h>
#include <udunits2.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <mutex>
#include <string>

namespace meltscope {
namespace {

struct FreeUnit {
    void operator()(ut_unit* unit) const { ut_free(unit); }
};
using UnitPointer = std::unique_ptr<ut_unit, FreeUnit>;

struct FreeConverter {
    void operator()(cv_converter* converter) const { cv_free(converter); }
};
using ConverterPointer = std::unique_ptr<cv_converter, FreeConverter>;

std::string_view without_blanks(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// An example of the quantity, for messages.
std::string example(const Quantity& quantity) {
    return std::string_view(quantity.unit) == "1" ? "0.5" : fmt::format("\"1.5 {}\"", quantity.unit);
}

/// "a length", "an angle".
std::string with_article(const Quantity& quantity) {
    const bool vowel = std::string_view("aeiou").find(quantity.name[0]) != std::string_view::npos;
    return fmt::format("{} {}", vowel ? "an" : "a", quantity.name);
}

/// 5 um is 5 / 10^6: the quotient is the double nearest to 5e-6, which the product 5 * 10^-6 often misses by
/// one bit.
double convert(const cv_converter* converter, double value) {
    const double at_zero = cv_convert_double(converter, 0.0);
    const double slope = cv_convert_double(converter, 1.0);
    const double inverse = std::round(1.0 / slope);
    const bool shrinks_by_whole_number =
        at_zero == 0.0 && inverse > 1.0 && inverse < 1e15 && std::abs(slope * inverse - 1.0) < 1e-15;
    return shrinks_by_whole_number ? value / inverse : cv_convert_double(converter, value);
}

/// Long or unprintable text would hide the message it stands in.
std::string shown(std::string_view text) {
    std::string result;
    for (const char c : text.substr(0, 60)) {
        result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return text.size() > 60 ? result + "..." : result;
}

/// The database of units. Reading it takes milliseconds and UDUNITS-2 (2.2.28) keeps 3 kB of it for good even
/// when it is given back, so there is one for the whole program.
struct Database {
    ut_system* system = nullptr;
    Database() {
        ut_set_error_message_handler(ut_ignore); // the library would write to stderr
        system = ut_read_xml(nullptr);
        if (system == nullptr) {
            throw UnitError(
                "the unit database of UDUNITS-2 cannot be read; install the package libudunits2-data");
        }
        const UnitPointer degree = parse("degree");
        ut_map_symbol_to_unit("deg", UT_ASCII, degree.get()); // the database lacks the common short form
    }
    ~Database() { ut_free_system(system); }
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    UnitPointer parse(const std::string& text) const {
        return UnitPointer(ut_parse(system, text.c_str(), UT_UTF8));
    }
};

} // namespace

double to_si(std::string_view text, const Quantity& quantity) {
    static std::mutex one_at_a_time; // UDUNITS-2's parser keeps its state in global variables
    const std::lock_guard lock(one_at_a_time);
    static const Database database;
    const std::string_view all = without_blanks(text);
    double value = 0.0;
    const char* begin = all.data();
    const char* const end = begin + all.size();
    if (begin != end && *begin == '+') {
        ++begin; // from_chars takes no plus sign
    }
    const auto [rest, error] = std::from_chars(begin, end, value);
    if (error == std::errc::result_out_of_range) {
        throw UnitError(fmt::format("\"{}\" does not fit into a double", shown(text)));
    }
    if (error != std::errc()) {
        throw UnitError(fmt::format("\"{}\" does not begin with a number; {} is written as {}", shown(text),
                                    with_article(quantity), example(quantity)));
    }
    if (!std::isfinite(value)) {
        throw UnitError(fmt::format("\"{}\" is not finite", shown(text)));
    }
    const std::string unit_text(without_blanks({rest, static_cast<std::size_t>(end - rest)}));
    if (unit_text.empty()) {
        if (std::string_view(quantity.unit) == "1") {
            return value;
        }
        throw UnitError(fmt::format("\"{}\" has no unit; {} is a number in {} or text such as {}",
                                    shown(text), with_article(quantity), quantity.unit, example(quantity)));
    }
    // A unit that itself begins with a number ("2 mm" in "5 2 mm") or names an instant is a slip, not a unit.
    const bool slip = unit_text.size() > 100 ||
                      std::string_view("0123456789.+-").find(unit_text[0]) != std::string_view::npos ||
                      unit_text.find_first_of("@:") != std::string::npos;
    const UnitPointer given = slip ? nullptr : database.parse(unit_text);
    if (!given) {
        throw UnitError(fmt::format("\"{}\" is not a unit; {} is written as {}", shown(unit_text),
                                    with_article(quantity), example(quantity)));
    }
    const UnitPointer wanted = database.parse(quantity.unit);
    const ConverterPointer converter(ut_are_convertible(given.get(), wanted.get()) != 0
                                         ? ut_get_converter(given.get(), wanted.get())
                                         : nullptr);
    // Reciprocals count as convertible (3 Hz to seconds); nobody means that.
    if (!converter || !std::isfinite(cv_convert_double(converter.get(), 0.0))) {
        throw UnitError(fmt::format("\"{}\" is not {}; it is written as {}", shown(text),
                                    with_article(quantity), example(quantity)));
    }
    const double result = convert(converter.get(), value);
    if (!std::isfinite(result)) {
        throw UnitError(fmt::format("\"{}\" does not fit into a double", shown(text)));
    }
    return result;
}

} // namespace meltscope
