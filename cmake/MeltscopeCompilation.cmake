# One interface target holds how every part of meltscope is compiled.
add_library(meltscope_compilation INTERFACE)
target_compile_features(meltscope_compilation INTERFACE cxx_std_20)
target_compile_options(meltscope_compilation INTERFACE -Wall -Wextra -Wno-psabi
                       # Where rooms are compiled whole, one file's names would shadow those of another.
                       $<$<NOT:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wshadow>
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized> # GCC 12 sees it in its own AVX-512 headers
                       $<$<CXX_COMPILER_ID:Clang>:-Wno-pass-failed>) # a loop left scalar is slow, not wrong
if(MELTSCOPE_WARNINGS_AS_ERRORS)
  target_compile_options(meltscope_compilation INTERFACE -Werror)
endif()
if(MELTSCOPE_BUILD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "The fuzzers need Clang (libFuzzer): cmake --preset fuzz, or -DCMAKE_CXX_COMPILER=clang++")
  endif()
  # Undefined behaviour ends the process, so that it is a finding and not a line in a log.
  set(_fuzz -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_compile_options(meltscope_compilation INTERFACE ${_fuzz})
  target_link_options(meltscope_compilation INTERFACE ${_fuzz})
endif()
if(MELTSCOPE_SANITIZE)
  target_compile_options(meltscope_compilation INTERFACE -fsanitize=${MELTSCOPE_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(meltscope_compilation INTERFACE -fsanitize=${MELTSCOPE_SANITIZE})
endif()

set(_arch "${MELTSCOPE_ARCH}")
if(_arch STREQUAL "")
  if(NOT MELTSCOPE_PORTABLE)
    set(_arch native)
  elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    set(_arch x86-64-v2)
  endif()
endif()
if(NOT _arch STREQUAL "")
  target_compile_options(meltscope_compilation INTERFACE -march=${_arch})
endif()
if(NOT MELTSCOPE_SIMD_WIDTH STREQUAL "native")
  target_compile_definitions(meltscope_compilation INTERFACE MELTSCOPE_SIMD_WIDTH=${MELTSCOPE_SIMD_WIDTH})
endif()

# For programs that draw: keeps their driver loaded, so that what it holds is not taken for leaks.
function(meltscope_keep_libraries target)
  if(MELTSCOPE_SANITIZE MATCHES "address")
    target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests/sanitizers/keep_libraries.cpp)
    set_target_properties(${target} PROPERTIES ENABLE_EXPORTS ON)
  endif()
endfunction()
