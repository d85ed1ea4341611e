#!/usr/bin/env bash
# Installs the Debian 12 packages that mocurate needs and that are missing. Usage: scripts/install.sh [programs|tests|develop|slurm]
set -euo pipefail
what=${1:-programs}

programs=(g++ cmake ninja-build ccache mold pkg-config git ca-certificates xz-utils
  libeigen3-dev libboost-dev nlohmann-json3-dev libexpected-dev libcli11-dev libyaml-cpp-dev libpugixml-dev libtomlplusplus-dev libtinygltf-dev libspdlog-dev libfmt-dev libssl-dev
  libhdf5-dev zlib1g-dev libzip-dev libpng-dev libceres-dev libsuitesparse-dev libopen3d-dev libopencv-dev libtorch-dev
  libjs-three libopenblas-dev libopenblas0-pthread libnanoflann-dev)
tests=(libgtest-dev libgmock-dev python3 python3-h5py python3-numpy python3-scipy hdf5-tools chromium chromium-driver python3-selenium locales procps binutils libblas3
  libassimp-dev mount parallel snakemake)
develop=(libbenchmark-dev clang-format clang-tidy clang libclang-rt-14-dev python3-torch)
slurm=(slurm-wlm munge)

wanted=("${programs[@]}")
case $what in
  programs) ;;
  tests) wanted+=("${tests[@]}") ;;
  develop) wanted+=("${tests[@]}" "${develop[@]}") ;;
  slurm) wanted+=("${slurm[@]}") ;;
  *) echo "install.sh: '$what' is not one of programs, tests, develop, slurm" >&2; exit 2 ;;
esac

missing=()
for package in "${wanted[@]}"; do
  dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null | grep -q '^ii' || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
fi

root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "install.sh: these packages are missing and need root or sudo to install: ${missing[*]}" >&2
    exit 4
  fi
  root=(sudo)
fi
echo "installing ${#missing[@]} Debian packages: ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${root[@]}" apt-get update -q >/dev/null
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}" >"$log" 2>&1; then
  tail -20 "$log" >&2
  echo "install.sh: apt-get could not install the packages above" >&2
  exit 4
fi
