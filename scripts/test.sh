#!/usr/bin/env bash
# Sets up, builds and runs every test; and the solver's tests once more as a portable build and as the scalar reference.
set -euo pipefail
cd "$(dirname "$0")/.."
exec </dev/null
export OMP_WAIT_POLICY=passive # threads that spin at barriers starve each other where cores are few

./scripts/setup.sh
strict=(${CI:+-DMELTSCOPE_WARNINGS_AS_ERRORS=ON})
solver_tests=(meltscope_{material,mpm,beam,surface_heat,build,run}_test)

cmake --preset release "${strict[@]}"
cmake --build --preset release

failed=()
for preset in portable scalar; do
  cmake --preset "$preset" "${strict[@]}"
  cmake --build --preset "$preset" --target "${solver_tests[@]}"
  for test in "${solver_tests[@]}"; do
    echo "== $test, $preset build"
    "./build/$preset/$test" --gtest_brief=1 || failed+=("$test ($preset)")
  done
done

echo "== every test, release build"
ctest --preset release --parallel "$(nproc)" || failed+=("ctest (release)")
if ((${#failed[@]} > 0)); then
  printf 'failed: %s\n' "${failed[@]}" >&2
  exit 1
fi
