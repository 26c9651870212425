#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <string>

namespace meltscope {

/// Does what a subcommand was asked to and returns the exit code.
using Action = std::function<int()>;

// Each adds a subcommand to the program; if it is the one on the command line, `chosen` is set.
void add_run(CLI::App& program, Action& chosen);
void add_check(CLI::App& program, Action& chosen);
void add_bench(CLI::App& program, Action& chosen);
void add_info(CLI::App& program, Action& chosen);
void add_movie(CLI::App& program, Action& chosen);
void add_render(CLI::App& program, Action& chosen);
void add_report(CLI::App& program, Action& chosen);
void add_attach(CLI::App& program, Action& chosen);

/// Version, git hash, compiler, SIMD width, VTK and HDF5 versions.
std::string version_text();

} // namespace meltscope
