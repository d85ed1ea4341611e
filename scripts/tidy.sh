#!/usr/bin/env bash
# Runs clang-tidy over the sources. Usage: scripts/tidy.sh [path pattern]
set -euo pipefail
cd "$(dirname "$0")/.."
command -v clang-tidy >/dev/null || scripts/install.sh develop
cmake --preset test -B build/tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DMOCURATE_UNITY=OFF \
  >/dev/null  # g++'s headers are not clang's
cmake --build build/tidy --target generated/resource_table.inc >/dev/null
git ls-files "${1:-*.cpp}" | grep -v '^tests/' | xargs -r -P "$(nproc)" -n 4 clang-tidy -p build/tidy --quiet \
  --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-unused-command-line-argument  # flags for g++
