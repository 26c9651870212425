#!/usr/bin/env bash
# Runs clang-tidy with the checks of .clang-tidy over the sources, or over the files named. tidy.sh [FILE...]
# Reads how each file is compiled from build/release (or BUILD), which must have been configured.
set -euo pipefail
cd "$(dirname "$0")/.."
build=${BUILD:-build/release}
if [[ ! -f $build/compile_commands.json ]]; then
  echo "tidy: there is no $build/compile_commands.json; configure that build, or name another in BUILD" >&2
  exit 1
fi
files=("$@")
if ((${#files[@]} == 0)); then
  mapfile -t files < <(git ls-files 'src/*.cpp' 'viz/*.cpp')
fi
# clang does not know GCC's -Wno-maybe-uninitialized
printf '%s\0' "${files[@]}" |
  xargs --null --max-procs="$(nproc)" --max-args=1 \
    clang-tidy --quiet -p "$build" --extra-arg=-Wno-unknown-warning-option
