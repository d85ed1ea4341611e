#!/usr/bin/env bash
# Installs what is missing, builds everything and runs all tests. Usage: scripts/test.sh [ctest arguments, e.g. -R store]
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install.sh tests

if [ -d ../shared/data ]; then
  export MOCURATE_DATA="$PWD/build/test-data"
  mkdir -p "$MOCURATE_DATA"
  bash ../shared/data/unpack.sh "$MOCURATE_DATA" >/dev/null
  export MOCURATE_GOLDENS="$(cd ../shared/goldens && pwd)"
else
  echo "test.sh: ../shared/data is not here: tests on recorded data are reported as skipped"
fi

cmake --preset test
cmake --build --preset test

export TMPDIR="$PWD/build/test/tmp" TEST_TMPDIR="$PWD/build/test/tmp/"  # files that tests leave are removed with the folder
rm -rf "$TMPDIR"
mkdir -p "$TMPDIR"
trap 'rm -rf "$TMPDIR"' EXIT

log=build/test/ctest.log
export MOCURATE_SKIPPED="$PWD/build/test/skipped_cases.txt"
rm -f "$MOCURATE_SKIPPED"
status=0
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1  # tests run side by side
ctest --test-dir build/test --output-on-failure -j "$(nproc)" "$@" 2>&1 | tee "$log" || status=$?
may_skip='^$'
if [ ! -e /dev/pts/ptmx ]; then
  echo "test.sh: /dev/pts is not mounted: tests on a terminal are skipped (mount -t devpts devpts /dev/pts)"
  may_skip=Terminal
fi
if [ -n "${MOCURATE_DATA:-}" ] && [ -e "$MOCURATE_SKIPPED" ] && grep -v "$may_skip" "$MOCURATE_SKIPPED"; then
  echo "test.sh: the cases above were skipped although ../shared/data is here: that is a failure" >&2
  exit 1
fi
exit $status
