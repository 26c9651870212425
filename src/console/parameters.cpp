#include "parameter_parts.hpp"

#include <fmt/format.h>

namespace meltscope {

std::string written(double value, const Quantity& quantity) {
    return std::string_view(quantity.unit) == "1" ? exact(value)
                                                  : fmt::format("{} {}", exact(value), quantity.unit);
}

std::string on_off(bool on) {
    return on ? "on" : "off";
}

double positive_time(Arguments& arguments, const std::string& what) {
    const double time = arguments.quantity(what, quantity::time);
    require_positive(time, what, "s");
    return time;
}

std::vector<Parameter> parameters_of(const std::vector<Laser>& lasers) {
    std::vector<Parameter> all;
    for (const std::vector<Parameter>& part :
         {laser_parameters(lasers), output_parameters(), physics_parameters(), boundary_parameters()})
        all.insert(all.end(), part.begin(), part.end());
    return all;
}

} // namespace meltscope
