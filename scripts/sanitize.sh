#!/usr/bin/env bash
# Builds the annotate slice with sanitizers and runs its tests. Usage: scripts/sanitize.sh [asan|tsan] [ctest arguments]
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install.sh tests
preset=${1:-asan}
shift || true
if [ -d ../shared/data ]; then
  export MOCURATE_DATA="$PWD/build/test-data"
  mkdir -p "$MOCURATE_DATA"
  bash ../shared/data/unpack.sh "$MOCURATE_DATA" >/dev/null
  export MOCURATE_GOLDENS="$(cd ../shared/goldens && pwd)"
fi
# A crash of a library is a signal there too: tests of readers on damaged files detect it.
export ASAN_OPTIONS=detect_leaks=1:abort_on_error=1 UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=suppressions=$PWD/cmake/leaks.supp
cmake --preset "$preset"
cmake --build --preset "$preset"
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1  # tests run side by side
ctest --test-dir "build/$preset" --output-on-failure -j "$(nproc)" "$@"
