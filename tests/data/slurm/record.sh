#!/usr/bin/env bash
# Records what Slurm's programs print, for tests that run without Slurm. It takes about 4 minutes.
# Usage: scripts/slurm_here.sh /tmp/slurm_recorded --nodes 2 -- tests/data/slurm/record.sh
set -euo pipefail
out=$(cd "$(dirname "$0")" && pwd)
folder=$(dirname "$SLURM_CONF")
format='%i|%T|%M|%N|%r'
cd "$folder"
rm -f "$out"/*.txt
printf 'file\texit\tcommand\n' >"$out/index.tsv"

# Writes stdout and stderr of a command to NAME.txt and its exit status to index.tsv.
keep() {
  local name=$1 status=0
  shift
  "$@" >"$out/$name.txt" 2>&1 || status=$?
  printf '%s.txt\t%s\t%s\n' "$name" "$status" "$(printf '%q ' "$@" | sed "s/ \$//; s/\\\\//g")" >>"$out/index.tsv"
}
submit() { sbatch --parsable -o "$folder/%A_%a.out" "$@"; }
states() { squeue -h -r -t all -j "$1" -o %T 2>/dev/null | sort | uniq -c | xargs; }
# Waits until a job has the state STATE (a pattern), at most SECONDS.
await() {
  local job=$1 state=$2 limit=$((SECONDS + ${3:-30}))
  until [[ $(states "$job") =~ $state ]]; do
    if [ $SECONDS -ge $limit ]; then
      echo "record.sh: job $job is '$(states "$job")', not $state, in time" >&2
      return 0
    fi
    sleep 0.3
  done
}
# Appends a line per second to NAME.txt: seconds, the state of node2, the jobs.
watch_jobs() {
  local name=$1 jobs=$2 until=$3 begin=$SECONDS
  while [ $((SECONDS - begin)) -lt "$until" ]; do
    echo "$((SECONDS - begin)) s  node2 $(sinfo -h -n node2 -o %T)  $(squeue -h -r -t all -j "$jobs" -o "$format" 2>&1 | xargs)" >>"$out/$name.txt"
    sleep 1
  done
}

cat >long.sh <<'END'
#!/bin/bash
trap 'echo "$SLURM_JOB_ID restart ${SLURM_RESTART_COUNT:-0} TERM $(date +%T)" >>signals.log; exit 143' TERM
while sleep 1; do echo "$SLURM_JOB_ID restart ${SLURM_RESTART_COUNT:-0} on $SLURMD_NODENAME $(date +%T)" >>beats.log; done
END
printf '#!/bin/bash\nsleep 3\n' >short.sh
printf '#!/bin/bash\nexit 3\n' >exit3.sh
printf '#!/bin/bash\nenv | grep ^SLURM | sort\n' >environment.sh

keep version sbatch --version
keep config scontrol show config
keep sinfo_idle sinfo
keep partition scontrol show partition debug
keep node_idle scontrol show node node1

keep sbatch sbatch -o /dev/null short.sh
keep sbatch_parsable sbatch --parsable -o /dev/null short.sh
keep sbatch_array_parsable sbatch --parsable -o /dev/null --array=0-9%2 short.sh
keep sbatch_no_partition sbatch -p nowhere short.sh
keep sbatch_array_too_large sbatch --array=0-1001 short.sh
keep sbatch_array_malformed sbatch --array=5-x short.sh
keep sbatch_account_unchecked sbatch -A other_lab -o /dev/null short.sh
echo "PartitionName=closed Nodes=ALL AllowAccounts=lab" >>"$SLURM_CONF"
scontrol reconfigure
keep sbatch_account_pending sbatch -p closed -A other_lab short.sh
keep sbatch_too_many_cpus sbatch -n 99 short.sh
keep sbatch_too_much_memory sbatch --mem=9999G short.sh
keep sbatch_bad_time sbatch --time=soon short.sh
keep sbatch_no_script sbatch missing.sh
keep sbatch_unknown_option sbatch --nonsense short.sh
keep sbatch_gpu sbatch --gres=gpu:1 short.sh
keep squeue_unknown_job squeue -h -j 999999 -o "$format"
keep show_job_unknown scontrol show job 999999
keep scancel_unknown scancel 999999
keep sacct sacct -j 1
keep partition_unknown scontrol show partition nowhere
sleep 3
keep squeue_pending_reasons squeue -h -t pending -o "$format"
scancel -u "$(id -un)"
# Clusters that refuse at once what no node or account can run.
echo "EnforcePartLimits=ALL" >>"$SLURM_CONF"
scontrol reconfigure
keep sbatch_enforced_account sbatch -p closed -A other_lab short.sh
keep sbatch_enforced_too_many_cpus sbatch -n 99 short.sh
sed -i '/^EnforcePartLimits/d; /^PartitionName=closed/d' "$SLURM_CONF"
scontrol reconfigure
scancel -u "$(id -un)"
sleep 4

timed=$(submit --time=1 long.sh)      # ends in TIMEOUT, recorded below
begin=$SECONDS
array=$(submit --array=0-9 short.sh)
sleep 0.5
keep squeue_array_pending squeue -j "$array" -o "$format"
await "$array" RUNNING
keep squeue_array_running squeue -j "$array" -o "$format"
keep squeue_array_running_expanded squeue -h -r -j "$array" -o "$format"
keep show_job_array scontrol show job "$array"
await "$array" '^10 COMPLETED$' 60
echo "array of 10 tasks of 3 s, 3 free CPUs: $((SECONDS - begin)) s"
keep squeue_array_done squeue -r -t all -j "$array" -o "$format"
keep squeue_array_done_active squeue -h -j "$array" -o "$format"
environment=$(submit --array=3 environment.sh)
await "$environment" COMPLETED
cp "${environment}_3.out" "$out/environment.txt"

failed=$(submit --array=0-1 exit3.sh)
await "$failed" '^2 FAILED$'
keep squeue_failed squeue -h -r -t all -j "$failed" -o "$format"
keep show_job_failed scontrol show job "${failed}_1"
held=$(submit --hold short.sh)
dependent=$(submit --dependency=afterok:"$failed" short.sh)
sleep 3
keep squeue_held squeue -h -j "$held" -o "$format"
keep squeue_dependency squeue -h -j "$dependent" -o "$format"
scancel "$held" "$dependent"

cancelled=$(submit --array=0-2 long.sh)
await "$cancelled" '^3 RUNNING$'
keep scancel scancel "${cancelled}_1"
squeue -h -r -t all -j "$cancelled" -o "$format" >"$out/squeue_cancelling.txt"
await "$cancelled" '1 CANCELLED'
keep squeue_cancelled squeue -h -r -t all -j "$cancelled" -o "$format"
keep show_job_cancelled scontrol show job "${cancelled}_1"
scancel "$cancelled"
untrapped=$(submit --wrap "sleep 30")
await "$untrapped" RUNNING
sleep 1
scancel "$untrapped"
await "$untrapped" CANCELLED
keep show_job_cancelled_by_signal scontrol show job "$untrapped"
await "$cancelled" '^3 CANCELLED$'

await "$timed" TIMEOUT 120
keep squeue_timeout squeue -h -t all -j "$timed" -o "$format"
keep show_job_timeout scontrol show job "$timed"

# An administrator sets a node down while jobs run on it. Its slurmd answers, so ReturnToService=2 makes it idle again at once.
requeued=$(submit -w node2 long.sh)
kept=$(submit -w node2 --no-requeue long.sh)
await "$requeued" RUNNING
await "$kept" RUNNING
keep set_down scontrol update nodename=node2 state=down reason=test
watch_jobs timeline_set_down "$requeued,$kept" 6
keep squeue_down squeue -h -t all -j "$requeued,$kept" -o "$format"
keep show_job_node_fail scontrol show job "$kept"
keep show_job_requeued scontrol show job "$requeued"
keep sinfo_down sinfo
keep node_down scontrol show node node2
scancel "$requeued"
sleep 3

# slurmd of a node is killed while jobs run on it; they may start on any node again.
scontrol update nodename=node1 state=drain reason=test
requeued=$(submit long.sh)
kept=$(submit --no-requeue long.sh)
await "$requeued" RUNNING
await "$kept" RUNNING
scontrol update nodename=node1 state=resume
rm -f beats.log
kill -KILL "$(cat run/node2.pid)"
echo "slurmd of node2 killed at $(date +%T)" >>beats.log
watch_jobs timeline_slurmd_killed "$requeued,$kept" 35
keep show_job_slurmd_killed_requeued scontrol show job "$requeued"
keep show_job_slurmd_killed_failed scontrol show job "$kept"
keep sinfo_not_responding sinfo
keep node_not_responding scontrol show node node2
keep sinfo_reasons sinfo -R
watch_jobs timeline_slurmd_killed_later "$requeued" 30
keep show_job_slurmd_killed_running scontrol show job "$requeued"
echo "slurmd of node2 started at $(date +%T)" >>beats.log
slurmd -N node2
watch_jobs timeline_slurmd_restarted "$requeued,$kept" 8
{ cat beats.log; cat signals.log 2>/dev/null || true; } >"$out/beats.txt"

# slurmctld is killed and started again while a job runs.
kill -KILL "$(cat run/slurmctld.pid)"
sleep 1
export SLURM_TIMEOUT=1
keep squeue_no_controller timeout 60 squeue -h -j "$requeued" -o "$format"
keep sbatch_no_controller timeout 60 sbatch short.sh
slurmctld
await "$requeued" . 30
keep squeue_after_controller squeue -h -t all -j "$requeued" -o "$format"
