#!/usr/bin/env bash
# Builds the fuzz targets with clang and sanitizers and runs each until it has tried so many inputs or for so long, whichever comes first.
# What they find lies in build/fuzz/findings with a table of the run (table.md); what they learnt, in build/fuzz/corpus, is where the next
# run goes on. Usage: scripts/fuzz.sh [SECONDS [INPUTS]] [TARGET ...]   (60 seconds; 2,000,000 inputs, 0: any number; all targets)
set -euo pipefail
cd "$(dirname "$0")/.."
limits=(60 2000000)
for i in 0 1; do
  if [[ ${1:-} =~ ^[0-9]+$ ]]; then limits[i]=$1; shift; fi
done
seconds=${limits[0]} inputs=${limits[1]}
[ "$inputs" -gt 0 ] || inputs=-1
command -v clang++ >/dev/null || scripts/install.sh develop
# Freed memory that AddressSanitizer keeps back counts as used: 16 MiB of it are enough.
export LSAN_OPTIONS=suppressions=$PWD/cmake/leaks.supp ASAN_OPTIONS=quarantine_size_mb=16
cmake --preset fuzz
cmake --build --preset fuzz

work=build/fuzz
rm -rf "$work/seeds"
mkdir -p "$work/findings"
"$work/bin/fuzz_seeds" "$work/seeds"
targets=("$@")
if [ ${#targets[@]} -eq 0 ]; then
  for program in "$work"/bin/fuzz_*; do
    [ "${program##*/}" = fuzz_seeds ] || targets+=("${program##*/fuzz_}")
  done
fi

table=$work/findings/table.md
printf '| target | inputs | seconds | peak MB | result |\n|---|---|---|---|---|\n' >"$table"
status=0
for target in "${targets[@]}"; do
  known=tests/fuzz/regressions/$target
  folders=("$work/corpus/$target" "$work/seeds/$target")
  [ ! -d "$known" ] || folders+=("$known")
  mkdir -p "${folders[@]}"
  echo "fuzz.sh: $target, at most $seconds s"
  log="$work/findings/$target.log"
  result=clean
  begin=$SECONDS
  "$work/bin/fuzz_$target" -max_total_time="$seconds" -runs="$inputs" -timeout=10 -rss_limit_mb=512 -malloc_limit_mb=512 -max_len=65536 \
    -print_final_stats=1 -artifact_prefix="$work/findings/$target-" "${folders[@]}" >"$log" 2>&1 || result=failed
  stat() { sed -n "s/^stat::$1: *//p" "$log"; }
  row="| $target | $(stat number_of_executed_units) | $((SECONDS - begin)) | $(stat peak_rss_mb) | $result |"
  echo "$row" | tee -a "$table"
  if [ $result = failed ]; then
    tail -40 "$log"
    echo "fuzz.sh: $target failed; the input lies in $work/findings, again with $work/bin/fuzz_$target FILE" >&2
    status=1
  fi
done
exit $status
