#!/usr/bin/env bash
# Builds with counters (preset coverage), runs the tests, and prints the lines that were run, room by room.
# coverage.sh [CTEST-OPTION...]; needs gcovr. The report by lines is build/coverage/report/index.html.
set -euo pipefail
cd "$(dirname "$0")/.."
export OMP_WAIT_POLICY=passive
if ! command -v gcovr >/dev/null; then
  echo "coverage: gcovr is missing (apt-get install gcovr)" >&2
  exit 1
fi
cmake --preset coverage
cmake --build --preset coverage
find build/coverage -name '*.gcda' -delete
ctest --preset coverage --parallel "$(nproc)" "$@" || echo "coverage: some tests failed; their lines count all the same" >&2

mkdir -p build/coverage/report
# Unity files are the compiler's view only: lines are told by the files they come from.
gcovr --root . --object-directory build/coverage --filter 'include/meltscope/' --filter 'src/' --filter 'viz/' \
  --exclude-throw-branches --json-summary build/coverage/report/summary.json \
  --html-details build/coverage/report/index.html build/coverage >/dev/null
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
