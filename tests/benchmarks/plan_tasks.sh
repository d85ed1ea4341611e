#!/usr/bin/env bash
# What plans and tasks cost: 432 clips of KARD as a plain run, and by mocurate plan and one task a stage; then the fitting
# stage as two tasks one after the other and side by side, with one worker each. Each pair is repeated; ratios of wall times.
# Usage: tests/benchmarks/plan_tasks.sh PROGRAM FOLDER [REPEATS]   (KARD lies in $MOCURATE_DATA/kinect/kard)
set -euo pipefail
program=$(realpath "$1") folder=$2 repeats=${3:-2}
: "${MOCURATE_DATA:?set it to the folder that has kinect/kard}"
mkdir -p "$folder"
cd "$folder"
export MOCURATE_CACHE=
clock() { date +%s.%N; }
minus() { awk -v a="$1" -v b="$2" 'BEGIN {printf "%.2f", a - b}'; }
ratio() { awk -v a="$1" -v b="$2" 'BEGIN {printf "%.3f", a / b}'; }
job() { local verb=$1; shift; "$program" "$verb" kard -q "$@"; }
stages() {  # RUN TASKS STAGE ...
  local run=$1 tasks=$2 stage
  shift 2
  for stage; do
    job plan --stage "$stage" --tasks "$tasks" -o "$run"
    [ "$tasks" -gt 1 ] || "$program" run --plan "$run/plan/$stage.json" --task 0 -q
  done
}
for ((i = 1; i <= repeats; i++)); do
  rm -rf plain tasks cache_plain cache_tasks
  a=$(clock)
  MOCURATE_CACHE=$PWD/cache_plain job run --to assemble -o plain
  b=$(clock)
  MOCURATE_CACHE=$PWD/cache_tasks stages tasks 1 ingest proportions fitting canon
  MOCURATE_CACHE=$PWD/cache_tasks job run --to assemble -o tasks
  c=$(clock)
  cmp plain/dataset.h5 tasks/dataset.h5
  echo "plan and tasks / plain: $(ratio "$(minus $c $b)" "$(minus $b $a)")  ($(minus $b $a) s plain)"
done
for ((i = 1; i <= repeats; i++)); do
  rm -rf one two cache_one cache_two
  for run in one two; do
    export MOCURATE_CACHE=$PWD/cache_$run
    stages $run 1 ingest proportions
    stages $run 2 fitting
  done
  export MOCURATE_CACHE=
  a=$(clock)
  for k in 0 1; do "$program" run --plan one/plan/fitting.json --task $k --jobs 1 -q; done
  b=$(clock)
  for k in 0 1; do "$program" run --plan two/plan/fitting.json --task $k --jobs 1 -q & done
  wait
  c=$(clock)
  echo "two tasks one after the other / side by side: $(ratio "$(minus $b $a)" "$(minus $c $b)")"
done
