#include "number_table.hpp"

#include <charconv>
#include <limits>

namespace meltscope {
namespace {

std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> cells;
    for (std::size_t start = 0;;) {
        const std::size_t end = line.find(',', start);
        cells.push_back(line.substr(start, end - start));
        if (end == std::string_view::npos)
            return cells;
        start = end + 1;
    }
}

double number_of(std::string_view cell) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    return error == std::errc{} && end == cell.data() + cell.size()
               ? value
               : std::numeric_limits<double>::quiet_NaN();
}

} // namespace

const std::vector<double>* NumberTable::find(std::string_view name) const {
    for (std::size_t n = 0; n < names.size(); ++n)
        if (names[n] == name)
            return &columns[n];
    return nullptr;
}

NumberTable parse_number_table(std::string_view text) {
    NumberTable table;
    for (std::size_t start = 0; start < text.size();) {
        const std::size_t end = text.find('\n', start);
        if (end == std::string_view::npos)
            break;
        const auto cells = split(text.substr(start, end - start));
        start = end + 1;
        if (table.names.empty()) {
            table.names.assign(cells.begin(), cells.end());
            table.columns.resize(cells.size());
            continue;
        }
        for (std::size_t n = 0; n < table.columns.size(); ++n)
            table.columns[n].push_back(n < cells.size() ? number_of(cells[n])
                                                        : std::numeric_limits<double>::quiet_NaN());
    }
    return table;
}

} // namespace meltscope
