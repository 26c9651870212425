#!/usr/bin/env bash
# From a bare Debian 12 machine to a movie of a laser track: sets up, builds, runs the main job, says where the results are.
set -euo pipefail
cd "$(dirname "$0")/.."

scenario=scenarios/in625_single_track.toml
folder=runs/in625_single_track

./scripts/setup.sh
cmake --preset release
cmake --build --preset release --target meltscope_app
./build/release/meltscope run "$scenario" --output "$folder" --overwrite

all_there=true
show() {   # show WHAT PATH...: where it is, or that it is missing
  local what=$1 path
  shift
  for path in "$@"; do
    if [[ -e $path ]]; then
      printf '  %-16s %s\n' "$what" "$PWD/$path"
    else
      printf '  %-16s missing: %s\n' "$what" "$PWD/$path"
      all_there=false
    fi
    what=
  done
}
echo
echo "Done. The results:"
show "movie" "$folder"/*.mp4
show "pictures" "$folder"/frames
show "ParaView files" "$folder"/*.pvd
show "melt-pool table" "$folder"/melt_pool.csv
$all_there
