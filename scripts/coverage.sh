#!/usr/bin/env bash
# Builds with counters (preset coverage), runs the tests, and prints the lines that were run, room by room.
# coverage.sh [CTEST-OPTION...]. The report by lines is build/coverage/report/index.html.
# Left out, as they run no line that the others do not and take most of the time: the verification cases, the kills at
# random moments and the random sessions.
set -euo pipefail
cd "$(dirname "$0")/.."
export OMP_WAIT_POLICY=passive
./scripts/setup.sh --checks
cmake --preset coverage -DMELTSCOPE_BUILD_VERIFICATION=OFF
cmake --build --preset coverage
find build/coverage -name '*.gcda' -delete
ctest --preset coverage --parallel "$(nproc)" --exclude-regex 'random_sessions|system\.soak' "$@" || echo "coverage: some tests failed; their lines count all the same" >&2

mkdir -p build/coverage/report
# Unity files are the compiler's view only: lines are told by the files they come from. What the tests' own objects see of
# the headers adds nothing and takes long to read.
gcovr --root . --object-directory build/coverage --filter 'include/meltscope/' --filter 'src/' --filter 'viz/' \
  --exclude-throw-branches --json-summary build/coverage/report/summary.json \
  --html-details build/coverage/report/index.html build/coverage/src build/coverage/viz >/dev/null
/usr/bin/python3 - <<'PYTHON'
import collections, json
lines = collections.defaultdict(lambda: [0, 0])
for file in json.load(open("build/coverage/report/summary.json"))["files"]:
    parts = file["filename"].split("/")
    room = "viz" if parts[0] == "viz" else parts[2 if parts[0] == "include" else 1]
    room = room if not room.endswith(".hpp") else "headers of all"
    lines[room][0] += file["line_covered"]
    lines[room][1] += file["line_total"]
for room in sorted(lines):
    covered, total = lines[room]
    print(f"{room:<16} {100.0 * covered / total:5.1f} % of {total} lines")
PYTHON
