#!/usr/bin/env bash
# Builds for valgrind (preset valgrind) and runs the files' and the readers' tests and a short run under memcheck.
set -euo pipefail
cd "$(dirname "$0")/.."
./scripts/setup.sh --checks
export OMP_NUM_THREADS=1
export OMP_WAIT_POLICY=passive # otherwise the program starts itself anew with it, which valgrind does not let it
tests=(meltscope_material_test meltscope_io_test meltscope_scenario_test)
cmake --preset valgrind
cmake --build --preset valgrind --target meltscope_app "${tests[@]}"

run=$(mktemp -d)
trap 'rm -rf "$run"' EXIT
memcheck() {
  echo "== $*"
  # Definite leaks only: libraries keep what they reach until the end.
  valgrind --quiet --error-exitcode=9 --suppressions=tests/sanitizers/valgrind.supp \
    --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite "$@"
}
for test in "${tests[@]}"; do
  memcheck "build/valgrind/$test" --gtest_brief=1 --gtest_filter='-*random*:*h5py*:*every_flipped_bit*:*robustness*'
done
memcheck build/valgrind/meltscope run scenarios/quick_look.toml --set "domain.cell_size=40 um" --set "time.max_step=4 us" \
  --set "time.end=40 us" --set "output.every=20 us" --set "checkpoint.every=20 us" --no-render --output "$run/run"
memcheck build/valgrind/meltscope run --restart "$run"/run/checkpoints/step_*0.h5 --steps 2 --no-render --output "$run/on"
