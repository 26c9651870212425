#!/usr/bin/env bash
# Sets up, builds and runs: every test; the solver's tests once more as a portable build and as the scalar reference; and
# every test once more under the address and undefined behaviour sanitizers. Goes on after a failure and names it at the end.
set -uo pipefail
cd "$(dirname "$0")/.." || exit
exec </dev/null
export OMP_WAIT_POLICY=passive # threads that spin at barriers starve each other where cores are few

strict=(${CI:+-DMELTSCOPE_WARNINGS_AS_ERRORS=ON})
solver_tests=(meltscope_{material,mpm,beam,surface_heat,build,run}_test)
failed=()

stage() { # NAME COMMAND...
  printf '\n== %s (%d s after the start)\n' "$1" "$SECONDS"
  "${@:2}" || failed+=("$1")
}
build() { # PRESET [--target NAME...]
  cmake --preset "$1" "${strict[@]}" && cmake --build --preset "$@"
}
run() { # PRESET
  ctest --preset "$1" --parallel "$(nproc)"
}

stage "packages" ./scripts/setup.sh --clang

stage "build" build quick
stage "tests" run quick

for preset in quick-portable quick-scalar; do
  stage "$preset build" build "$preset" --target "${solver_tests[@]}"
  for test in "${solver_tests[@]}"; do
    stage "$preset $test" "./build/$preset/$test" --gtest_brief=1
  done
done

stage "sanitized build" build asan
stage "sanitized tests" run asan

printf '\n== done in %d s\n' "$SECONDS"
if ((${#failed[@]} > 0)); then
  printf 'failed: %s\n' "${failed[@]}" >&2
  exit 1
fi
