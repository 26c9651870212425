#include "meltscope/io/solidification_table.hpp"

#include "meltscope/io/atomic_file.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string>

namespace meltscope {

void write_solidification_table(const std::filesystem::path& path, std::span<const SolidifiedPoint> points) {
    std::string text = "x,y,z,tm,tl,cr\n";
    for (const SolidifiedPoint& p : points)
        fmt::format_to(std::back_inserter(text), "{:.10g},{:.10g},{:.10g},{:.12g},{:.12g},{:.9g}\n",
                       p.position[0], p.position[1], p.position[2], p.melted, p.solidified, p.cooling_rate);
    write_file_atomically(path, text);
}

} // namespace meltscope
