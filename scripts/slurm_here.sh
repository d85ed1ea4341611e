#!/usr/bin/env bash
# Starts a Slurm cluster on this machine without systemd, runs COMMAND in it with SLURM_CONF exported, and stops it, with every job left.
# Usage: scripts/slurm_here.sh FOLDER [--nodes N] -- COMMAND ...   (1 node; several are one slurmd each, named node1 to nodeN)
# Each node declares 2 CPUs, whatever the machine has. All files lie in FOLDER: slurm.conf, log/, run/ (process ids), spool/, state/.
# Exit status: COMMAND's; 1: the cluster did not start; 2: wrong arguments; 4: packages are missing.
set -euo pipefail

usage() {
  echo "slurm_here.sh: $1; usage: scripts/slurm_here.sh FOLDER [--nodes N] -- COMMAND ..." >&2
  exit 2
}

[ $# -gt 0 ] && [ "$1" != -- ] || usage "FOLDER is missing"
folder=$1 nodes=1
shift
if [ "${1:-}" = --nodes ]; then
  nodes=${2:-}
  [[ $nodes =~ ^[1-9][0-9]?$ ]] || usage "--nodes is '$nodes', not a number from 1 to 99"
  shift 2
fi
[ "${1:-}" = -- ] || usage "'${1:-}' stands where -- is expected"
shift
[ $# -gt 0 ] || usage "COMMAND is missing"

export PATH=$PATH:/usr/sbin:/sbin
for program in munged slurmctld slurmd sbatch; do
  if ! command -v "$program" >/dev/null; then
    echo "slurm_here.sh: $program is missing; install it with: apt-get install -y --no-install-recommends slurm-wlm munge" >&2
    exit 4
  fi
done

mkdir -p "$folder"
folder=$(realpath "$folder")
# Slurm's sockets lie in FOLDER/spool; the system limits their paths to 107 bytes. Slurm's settings take no blanks or '#'.
if [ ${#folder} -gt 64 ] || [[ $folder =~ [[:space:]\#%,=] ]]; then
  echo "slurm_here.sh: FOLDER is $folder; it must have at most 64 characters and no blank, '#', '%', ',' or '='; choose another" >&2
  exit 2
fi

# A daemon of this cluster has one of these names and a file in FOLDER/log open. That also finds a daemon that COMMAND started, and a
# slurmstepd, which outlives its slurmd.
daemons() {
  local process
  for process in $(pgrep -x "$1" || true); do
    if find "/proc/$process/fd" -lname "$folder/log/*" 2>/dev/null | grep -q .; then echo "$process"; fi
  done
}

kill_tree() {
  local child
  for child in $(pgrep -P "$1" || true); do kill_tree "$child"; done
  kill -KILL "$1" 2>/dev/null || true
}

stop() {
  local name process
  # slurmctld stops first: it would requeue the jobs of the others.
  for name in slurmctld slurmd slurmstepd munged; do
    for process in $(daemons "$name"); do
      if [ "$name" = slurmstepd ]; then kill_tree "$process"; else kill -TERM "$process" 2>/dev/null || true; fi
    done
    for _ in {1..50}; do
      [ -n "$(daemons "$name")" ] || continue 2
      sleep 0.1
    done
    for process in $(daemons "$name"); do kill -KILL "$process" 2>/dev/null || true; done
  done
}

exec 9>"$folder/lock"
if ! flock -n 9; then
  echo "slurm_here.sh: a cluster runs in $folder already; choose another folder or end that one" >&2
  exit 1
fi
stop  # what a killed slurm_here.sh left
rm -rf "$folder"/{log,run,spool,state}
mkdir -p "$folder"/{log,run,spool,state}
command=
trap 'status=$?; trap - INT TERM HUP; [ -z "$command" ] || kill -TERM "$command" 2>/dev/null || true; stop; exit $status' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
trap 'exit 129' HUP

used() { (: <>"/dev/tcp/127.0.0.1/$1") 2>/dev/null; }
port=
for _ in {1..100}; do
  port=$((20000 + RANDOM % 10000))
  for ((i = 0; i <= nodes; i++)); do
    if used $((port + i)); then port=; break; fi
  done
  [ -z "$port" ] || break
done
if [ -z "$port" ]; then
  echo "slurm_here.sh: no $((nodes + 1)) free ports in a row between 20000 and 30000 in 100 tries" >&2
  exit 1
fi

host=$(hostname -s) user=$(id -un)
# A requeued job becomes eligible cred_expire + 1 seconds later: 11 s here, 121 s by Slurm's default.
memory=$(awk '/^MemTotal/ {print int($2 / 1024)}' /proc/meminfo)
cat >"$folder/slurm.conf" <<END
ClusterName=here
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/run/munge.socket,cred_expire=10
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool/%n
SlurmctldPidFile=$folder/run/slurmctld.pid
SlurmdPidFile=$folder/run/%n.pid
SlurmctldLogFile=$folder/log/slurmctld.log
SlurmdLogFile=$folder/log/%n.log
SlurmctldDebug=info
SlurmdDebug=info
SlurmdTimeout=10
KillWait=5
ReturnToService=2
MaxArraySize=1001
MailProg=/bin/true
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=5
SlurmdParameters=config_overrides
END
for ((i = 1; i <= nodes; i++)); do
  echo "NodeName=node$i NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + i)) State=UNKNOWN" \
    "CPUs=2 Sockets=1 CoresPerSocket=2 ThreadsPerCore=1 RealMemory=$memory" >>"$folder/slurm.conf"
done
echo "PartitionName=debug Nodes=ALL Default=YES MaxTime=INFINITE OverSubscribe=YES:2 State=UP" >>"$folder/slurm.conf"
echo "CgroupAutomount=no" >"$folder/cgroup.conf"
export SLURM_CONF=$folder/slurm.conf

failed() {
  echo "slurm_here.sh: $1; the last lines of the logs in $folder/log:" >&2
  tail -n 15 "$folder"/log/* >&2
  exit 1
}

# munged runs as this user, with a key and a socket in FOLDER, so that /etc/munge and /run/munge are not touched.
(umask 077 && head -c 128 /dev/urandom >"$folder/run/munge.key")
munged --force --key-file="$folder/run/munge.key" --socket="$folder/run/munge.socket" --pid-file="$folder/run/munged.pid" \
  --log-file="$folder/log/munged.log" --seed-file="$folder/run/munge.seed" 9>&- >>"$folder/log/start.log" 2>&1 || failed "munged did not start"
slurmctld -c 9>&- >>"$folder/log/start.log" 2>&1 || failed "slurmctld did not start"
for ((i = 1; i <= nodes; i++)); do
  slurmd -N "node$i" 9>&- >>"$folder/log/start.log" 2>&1 || failed "slurmd of node$i did not start"
done

begin=$SECONDS
until [ "$(timeout 10 sinfo -h -N -o %T 2>/dev/null | grep -cx idle)" -eq "$nodes" ]; do
  [ $((SECONDS - begin)) -lt 30 ] || failed "not all of $nodes nodes are idle after 30 s"
  sleep 0.2
done

"$@" <&0 9>&- &
command=$!
status=0
wait "$command" || status=$?
command=
exit $status
