#!/usr/bin/env bash
# Installs the Debian packages that meltscope needs to be built, run and tested. Says which; does nothing if all are there.
# With --clang also Clang, for the sanitizers and the fuzzers; with --checks what tidy.sh, memcheck.sh and coverage.sh need.
set -euo pipefail

packages=(
  # to build
  build-essential g++ cmake ninja-build git
  libvtk9-dev libeigen3-dev libhdf5-dev libcli11-dev libtomlplusplus-dev libfmt-dev libspdlog-dev libedit-dev
  libudunits2-dev nlohmann-json3-dev
  # to draw without a display and to make movies
  xvfb xauth libgl1-mesa-dri ffmpeg
  # to test, and to read the results with other programs
  libgtest-dev libbenchmark-dev python3-vtk9 python3-meshio python3-h5py python3-numpy python3-matplotlib
  python3-pyte
)
for option in "$@"; do
  case $option in
    --clang) packages+=(clang libclang-rt-dev libomp-dev llvm) ;;
    --checks) packages+=(clang clang-tidy libomp-dev valgrind gcovr) ;;
    *)
      echo "setup: the options are --clang and --checks, not $option" >&2
      exit 2
      ;;
  esac
done

missing=()
for package in "${packages[@]}"; do
  if [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null) != installed ]]; then
    missing+=("$package")
  fi
done
if ((${#missing[@]} == 0)); then
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "setup: packages are missing, and neither root nor sudo is at hand. As root, run:" >&2
    echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o Acquire::Retries=3 -o Dpkg::Use-Pty=0 -qq "$@" </dev/null
}
install_missing() { apt install --yes --no-install-recommends "${missing[@]}"; }

echo "setup: installing ${missing[*]}"
if ! install_missing; then
  echo "setup: the package lists may be old or absent; fetching them and trying once more"
  apt update
  install_missing
fi
