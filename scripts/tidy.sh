#!/usr/bin/env bash
# Runs clang-tidy with the checks of .clang-tidy over all rooms. tidy.sh [ROOM...], for example: tidy.sh io console
# Reads how they are compiled from build/asan (or BUILD), where each room is one file and headers are read once.
set -euo pipefail
cd "$(dirname "$0")/.."
./scripts/setup.sh --checks
build=${BUILD:-build/asan}
[[ -f $build/compile_commands.json ]] || cmake --preset asan >/dev/null
rooms=("$@")
if ((${#rooms[@]} == 0)); then rooms=(material mpm beam build run scenario io console viz app); fi
for room in "${rooms[@]}"; do
  find "$build" -path '*/Unity/*' -name "unity_${room}_cxx.cxx" -print0
done | xargs --null --max-procs="$(nproc)" --max-args=1 clang-tidy --quiet -p "$build"
