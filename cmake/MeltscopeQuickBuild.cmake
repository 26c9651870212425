# Builds from scratch in less time, at the price of longer builds after a change.
# The solver's speed depends on what the compiler sees at once: what is measured is built with `off` or `around_solver`.
set(MELTSCOPE_QUICK_BUILD "off" CACHE STRING
    "Compile each room as one file, and tests on precompiled headers: off, around_solver (not the solver's rooms) or all")
set_property(CACHE MELTSCOPE_QUICK_BUILD PROPERTY STRINGS off around_solver all)
if(NOT MELTSCOPE_QUICK_BUILD MATCHES "^(off|around_solver|all)$")
  message(FATAL_ERROR "MELTSCOPE_QUICK_BUILD is \"${MELTSCOPE_QUICK_BUILD}\": expected off, around_solver or all")
endif()

# Compiles the sources of a target room by room. A name that is local to a file is then to be unique in its room.
# The solver's files are compiled one by one with `around_solver`, on the headers that nearly all of them include.
function(meltscope_compile_rooms_whole target)
  if(MELTSCOPE_QUICK_BUILD STREQUAL "off")
    return()
  endif()
  if(target STREQUAL "meltscope" AND MELTSCOPE_QUICK_BUILD STREQUAL "around_solver")
    target_precompile_headers(meltscope PRIVATE
      <algorithm> <cmath> <functional> <numeric> <string> <vector> <fmt/format.h> <Eigen/Geometry> <meltscope/mpm/group_stencils.hpp>)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(path ${source} ABSOLUTE)
    get_filename_component(folder ${path} DIRECTORY)
    get_filename_component(room ${folder} NAME)
    set_source_files_properties(${path} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${room})
  endforeach()
endfunction()

# Compiles a test on the headers that nearly all of them include.
function(meltscope_precompile_test_headers target)
  if(MELTSCOPE_QUICK_BUILD STREQUAL "off")
    return()
  endif()
  if(NOT TARGET meltscope_test_headers)
    file(WRITE ${PROJECT_BINARY_DIR}/generated/test_headers.cpp "")
    add_library(meltscope_test_headers OBJECT ${PROJECT_BINARY_DIR}/generated/test_headers.cpp)
    target_link_libraries(meltscope_test_headers PRIVATE meltscope GTest::gtest)
    target_precompile_headers(meltscope_test_headers PRIVATE
      <gtest/gtest.h> <fmt/format.h> <filesystem> <fstream> <random> <meltscope/run/run_loop.hpp>)
  endif()
  target_precompile_headers(${target} REUSE_FROM meltscope_test_headers)
  # GCC takes them only under the same definitions; programs that are no GoogleTest lack these.
  target_compile_options(${target} PRIVATE $<TARGET_PROPERTY:GTest::gtest,INTERFACE_COMPILE_OPTIONS>)
endfunction()
