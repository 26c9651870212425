#!/usr/bin/env bash
# Builds the fuzzers and runs them, one after another or those that are named, MINUTES each (30).
#   scripts/fuzz.sh [INPUT...]        INPUT: scenario material path ball stl console journal checkpoint
# What was learnt lies in build/fuzz/corpus/INPUT, what was found in build/fuzz/found/INPUT-*.
set -euo pipefail
cd "$(dirname "$0")/.."
inputs=("$@")
((${#inputs[@]})) || inputs=(scenario material path ball stl console journal checkpoint)

declare -A dictionary=([scenario]=toml [material]=toml [path]=path [ball]=path [stl]=stl
                       [console]=console [journal]=console [checkpoint]=console)
for input in "${inputs[@]}"; do
  if [[ -z ${dictionary[$input]-} ]]; then
    echo "fuzz: there is no input $input; there are ${!dictionary[*]}" >&2
    exit 2
  fi
done

./scripts/setup.sh --clang
cmake --preset fuzz
cmake --build --preset fuzz --target "${inputs[@]/%/_fuzz}"

export OMP_NUM_THREADS=1
export UDUNITS2_XML_PATH=$PWD/tests/fuzz/units.xml # the whole database takes longer to read than an input
export LSAN_OPTIONS=suppressions=$PWD/tests/sanitizers/leaks.supp:print_suppressions=0
result=0
for input in "${inputs[@]}"; do
  echo "fuzz: $input"
  mkdir -p "build/fuzz/corpus/$input" build/fuzz/found
  # Leaks are looked for at the end (by the sanitizer) and not after each input, which took twenty times as long as the
  # input. Paths are whole, since the console's fuzzer works in a folder of its own.
  "build/fuzz/${input}_fuzz" -max_total_time=$((60 * ${MINUTES:-30})) -detect_leaks=0 -timeout=60 -rss_limit_mb=2048 \
    -max_len=3000 -print_final_stats=1 -dict="$PWD/tests/fuzz/dictionaries/${dictionary[$input]}.dict" \
    -artifact_prefix="$PWD/build/fuzz/found/$input-" "$PWD/build/fuzz/corpus/$input" "$PWD/tests/fuzz/corpus/$input" || result=1
done
exit $result
