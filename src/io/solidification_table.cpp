#include "meltscope/io/solidification_table.hpp"

#include "meltscope/io/atomic_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <string>

namespace meltscope {
namespace {

/// To a picometre, so that a plane of nodes at zero is not written as the round-off of a sum of cells.
double rounded(double coordinate) {
    return std::round(coordinate * 1e12) / 1e12 + 0.0; // and -0 becomes 0
}

} // namespace

void write_solidification_table(const std::filesystem::path& path, std::span<const SolidifiedPoint> points) {
    std::string text = "x,y,z,tm,tl,cr\n";
    for (const SolidifiedPoint& p : points)
        fmt::format_to(std::back_inserter(text), "{:.10g},{:.10g},{:.10g},{:.12g},{:.12g},{:.9g}\n",
                       rounded(p.position[0]), rounded(p.position[1]), rounded(p.position[2]), p.melted,
                       p.solidified, p.cooling_rate);
    write_file_atomically(path, text);
}

} // namespace meltscope
