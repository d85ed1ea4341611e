#!/usr/bin/env bash
# Runs 432 clips of KARD as arrays of a real Slurm of two nodes on this machine, and breaks them: a task is killed, a node is
# stopped, the scratch disk is full. Each run must give the dataset.h5 of a plain one and repeat nothing that was done.
# Usage: scripts/test_slurm.sh PROGRAM FOLDER [SCENARIO ...]   scenarios: plain faults scratch refusals (default: all)
# KARD lies in $MOCURATE_DATA/kinect/kard. Needs root (a tmpfs is the full disk) and the packages of scripts/install.sh slurm.
set -euo pipefail

if [ -z "${SLURM_CONF:-}" ]; then
  [ $# -ge 2 ] || { echo "usage: scripts/test_slurm.sh PROGRAM FOLDER [SCENARIO ...]" >&2; exit 2; }
  program=$(realpath "$1") folder=$(realpath -m "$2")
  shift 2
  exec "$(dirname "$(realpath "$0")")/slurm_here.sh" "$folder/slurm" --nodes 2 -- "$(realpath "$0")" "$program" "$folder" "$@"
fi
program=$1 folder=$2
shift 2
scenarios=${*:-plain faults scratch refusals}
: "${MOCURATE_DATA:?set it to the folder that has kinect/kard}"
cd "$folder"

run() {  # NAME OPTION...: a run of KARD in a cache of its own
  local name=$1
  shift
  MOCURATE_CACHE=$folder/cache_$name "$program" run kard --to assemble -o "$folder/run_$name" -j 2 "$@"
}
on_slurm() {
  local name=$1
  shift
  run "$name" --executor slurm --set 'slurm.task_time=5 s' --set 'slurm.time=10 min' "$@"
}
same() {
  cmp "run_$1/dataset.h5" plain.h5 || { echo "FAILED: $1: dataset.h5 differs from the plain run" >&2; exit 1; }
  echo "ok: $1: dataset.h5 as of the plain run"
}
# Items of stage $2 that run $1 executed and finished, over all journals: each is one line.
executed() {
  { cat "run_$1/journal.jsonl" "run_$1/plan/$2"/*.jsonl 2>/dev/null || true; } |
    awk -v stage="\"stage\":\"$2\"" 'index($0, stage) && /"from_cache":false/ && /"outcome":"(done|suspect)"/' | wc -l
}
once() {
  local stage count wanted
  for stage in ingest fitting canon; do
    count=$(executed "$1" $stage)
    wanted=$(executed reference $stage)
    [ "$count" -eq "$wanted" ] || { echo "FAILED: $1: $count items of $stage were executed, not $wanted" >&2; exit 1; }
    echo "ok: $1: $stage: $count items executed, as in the plain run"
  done
}
# Waits until a task of stage $2 of run $1 is at work on node $3 and has finished items; prints its process.
task_on() {
  local process
  for _ in {1..600}; do
    for process in $(pgrep -f "plan/$2.json --task" || true); do
      tr '\0' '\n' <"/proc/$process/environ" 2>/dev/null | grep -qx "SLURMD_NODENAME=$3" || continue
      if grep -qs '"outcome":' "run_$1/plan/$2"/*.jsonl; then echo "$process"; return; fi
    done
    sleep 0.1
  done
  echo "FAILED: no task of $2 on $3" >&2
  exit 1
}

if [ ! -e plain.h5 ]; then
  SECONDS=0
  run reference -q
  echo "plain run: $SECONDS s"
  cp run_reference/dataset.h5 plain.h5
fi

for scenario in $scenarios; do
  SECONDS=0
  case $scenario in
    plain)
      on_slurm plain
      same plain
      once plain
      "$program" jobs run_plain
      ;;
    faults)
      on_slurm faults --no-wait
      kill -KILL "$(task_on faults fitting node1)"
      echo "a task of fitting is killed"
      process=$(task_on faults fitting node2)
      pkill -KILL -f "slurmd -N node2"
      for process in $(grep -lsz SLURMD_NODENAME=node2 /proc/[0-9]*/environ | grep -o '[0-9]*'); do
        kill -KILL "$(awk '/^PPid/ {print $2}' "/proc/$process/status")" "$process" 2>/dev/null || true
      done
      echo "node2 is stopped"
      on_slurm faults
      same faults
      once faults
      slurmd -N node2
      ;;
    scratch)
      mkdir -p full
      mount -t tmpfs -o size=64k tmpfs full
      status=0
      on_slurm scratch --set "slurm.scratch=$folder/full" || status=$?
      umount full
      [ $status -eq 1 ] || [ $status -eq 74 ] || { echo "FAILED: exit code $status of a full scratch disk" >&2; exit 1; }
      echo "ok: a full scratch disk ends the run with exit code $status"
      on_slurm scratch
      same scratch
      once scratch
      ;;
    refusals)
      status=0
      on_slurm refused --set slurm.partition=nowhere || status=$?
      [ $status -eq 2 ] || { echo "FAILED: exit code $status for an unknown partition" >&2; exit 1; }
      status=0
      PATH=/nowhere on_slurm refused || status=$?
      [ $status -eq 4 ] || { echo "FAILED: exit code $status without Slurm in PATH" >&2; exit 1; }
      echo "ok: refusals"
      ;;
    *) echo "unknown scenario $scenario" >&2; exit 2 ;;
  esac
  echo "$scenario: $SECONDS s"
done
