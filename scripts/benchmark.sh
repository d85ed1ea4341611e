#!/usr/bin/env bash
# Builds the benchmarks and runs those whose name contains NAME, with one thread each. Usage: scripts/benchmark.sh [NAME [ARGUMENTS ...]]
# Without NAME all of them, with their defaults; arguments go to each benchmark that runs (docs/benchmarks.md).
set -euo pipefail
cd "$(dirname "$0")/.."
[ -f /usr/include/benchmark/benchmark.h ] || scripts/install.sh develop
name=${1:-}
shift || true
benchmarks=()
for source in tests/benchmarks/*"$name"*.cpp; do
  [ -e "$source" ] && benchmarks+=("bench_$(basename "$source" .cpp)")
done
if [ ${#benchmarks[@]} -eq 0 ]; then
  echo "benchmark.sh: no benchmark is named '$name'; the benchmarks are: $(cd tests/benchmarks && basename -s .cpp *.cpp | xargs)" >&2
  exit 2
fi
if [ -d ../shared/data ] && [ -z "${MOCURATE_DATA:-}" ]; then
  export MOCURATE_DATA="$PWD/build/test-data"
  mkdir -p "$MOCURATE_DATA"
  bash ../shared/data/unpack.sh "$MOCURATE_DATA" >/dev/null
fi
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
cmake --preset benchmark
cmake --build --preset benchmark --target "${benchmarks[@]}"
status=0
for benchmark in "${benchmarks[@]}"; do
  echo "benchmark.sh: $benchmark $*"
  "build/benchmark/bin/$benchmark" "$@" || status=$?
done
exit $status
