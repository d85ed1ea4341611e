#!/usr/bin/env bash
# Runs clang-tidy over the sources of a configured build. Usage: scripts/tidy.sh [path pattern]
set -euo pipefail
cd "$(dirname "$0")/.."
command -v clang-tidy >/dev/null || scripts/install.sh develop
cmake --preset test >/dev/null
git ls-files "${1:-*.cpp}" | grep -v '^tests/' | xargs -r -P "$(nproc)" -n 4 clang-tidy -p build/test --quiet \
  --extra-arg=-Wno-unknown-warning-option  # some flags are for g++ only
