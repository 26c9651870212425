#!/usr/bin/env bash
# Kills runs at random moments (default 50) and shows that nothing is lost. soak.sh [MOMENTS] [--seed N] [--pictures]
set -euo pipefail
cd "$(dirname "$0")/.."
export MELTSCOPE_PROGRAM=${MELTSCOPE_PROGRAM:-$PWD/build/release/meltscope}
export OMP_WAIT_POLICY=passive
if [[ ! -x $MELTSCOPE_PROGRAM ]]; then
  echo "soak: there is no $MELTSCOPE_PROGRAM; build it, or name another in MELTSCOPE_PROGRAM" >&2
  exit 1
fi
exec /usr/bin/python3 tests/system/soak.py "$@"
