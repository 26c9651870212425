#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace meltscope {

/// A table of numbers by column, as melt_pool.csv holds one. All columns are equally long.
struct NumberTable {
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;

    /// The column of that name; null if there is none.
    const std::vector<double>* find(std::string_view name) const;
};

/// Reads comma-separated text with a header line; what is no number becomes NaN. A last line without its end
/// is left out: it is still being written.
NumberTable parse_number_table(std::string_view text);

} // namespace meltscope
