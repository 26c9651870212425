#pragma once

#include "meltscope/console/parameters.hpp"

#include <limits>
#include <string>
#include <vector>

/// The parameters by subject, and what their readers have in common.
namespace meltscope {

std::vector<Parameter> laser_parameters(const std::vector<Laser>& lasers);
std::vector<Parameter> output_parameters();
std::vector<Parameter> physics_parameters();
std::vector<Parameter> boundary_parameters();

inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// A value as the journal keeps it.
std::string written(double value, const Quantity& quantity);
std::string on_off(bool on);
/// A speed above zero that a scanner could move a beam at, m/s.
double read_scan_speed(Arguments& arguments, const std::vector<std::string>& keywords = {});
/// A time above zero, s.
double positive_time(Arguments& arguments, const std::string& what);

} // namespace meltscope
