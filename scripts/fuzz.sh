#!/usr/bin/env bash
# Builds the fuzz targets with clang and sanitizers and runs each for a while. What they find lies in build/fuzz/findings; what they learnt,
# in build/fuzz/corpus, is where the next run goes on. Usage: scripts/fuzz.sh [SECONDS_PER_TARGET] [TARGET ...]   (60 seconds; all targets)
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}
shift || true
command -v clang++ >/dev/null || scripts/install.sh develop
export LSAN_OPTIONS=suppressions=$PWD/cmake/leaks.supp
cmake --preset fuzz
cmake --build --preset fuzz

work=build/fuzz
rm -rf "$work/seeds"
mkdir -p "$work/findings"
"$work/bin/fuzz_seeds" "$work/seeds"
targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
  for program in "$work"/bin/fuzz_*; do targets+=("${program##*/fuzz_}"); done
  targets=("${targets[@]/#seeds/}")
fi

status=0
for target in "${targets[@]}"; do
  [ -n "$target" ] || continue
  mkdir -p "$work/corpus/$target" "$work/seeds/$target"
  echo "fuzz.sh: $target for $seconds s"
  log="$work/findings/$target.log"
  if "$work/bin/fuzz_$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=1024 -malloc_limit_mb=512 -max_len=65536 \
    -artifact_prefix="$work/findings/$target-" "$work/corpus/$target" "$work/seeds/$target" >"$log" 2>&1; then
    grep "^Done" "$log"
  else
    tail -40 "$log"
    echo "fuzz.sh: $target failed; the input lies in $work/findings, again with $work/bin/fuzz_$target FILE" >&2
    status=1
  fi
done
exit $status
