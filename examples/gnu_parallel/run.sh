#!/bin/sh
# run.sh CONFIG RUN TASKS: the stages of a run as tasks of GNU parallel; with --sshlogin, on other machines.
# -q: the shell that parallel starts takes no character of a path for its own. --env: tasks need the cache of the plan.
set -e
for stage in ingest proportions fitting canon; do
  tasks=$(mocurate plan "$1" -o "$2" --stage $stage --tasks "$3" --json | sed -n 's/.*"tasks": \([0-9]*\).*/\1/p')
  [ "$tasks" = 0 ] || seq 0 $((tasks - 1)) | parallel -q --env MOCURATE_CACHE --halt soon,fail=1 mocurate run --plan "$2/plan/$stage.json" --task {}
done
mocurate run "$1" -o "$2" --to assemble
