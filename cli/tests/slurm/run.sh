#!/bin/sh
# A campaign as a Slurm job array of four shards on a one-node cluster on loopback, against the same campaign in one go.
#
#     cli/tests/slurm/run.sh [PROGRAM]
#
# For Debian and its relatives, as root, in a container of its own: it installs slurm-wlm and munge, starts munged, slurmctld and
# slurmd, and stops what it started. Run on demand, not in every CI.
set -eu
program=$(realpath "${1:-target/release/sinscal}")
work=$(mktemp -d)
started=""
stop() {
    # in the opposite order, and only what was started here
    for pid in $started; do kill "$pid" 2>/dev/null || true; done
    wait
    rm -rf "$work"
}
trap stop EXIT
trap 'exit 1' INT TERM

if ! command -v slurmctld >/dev/null || ! command -v munged >/dev/null; then
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends slurm-wlm munge
fi

mkdir -p "$work/munge" "$work/state" "$work/spool" "$work/results"
chmod 755 "$work"
chmod 711 "$work/munge"
dd if=/dev/urandom of="$work/munge/key" bs=1024 count=1 2>/dev/null
chmod 600 "$work/munge/key"
munged --foreground --force --num-threads 2 --key-file "$work/munge/key" --socket "$work/munge/socket" \
    --pid-file "$work/munge/pid" --log-file "$work/munge/log" --seed-file "$work/munge/seed" &
started="$! $started"

host=$(hostname -s)
cat >"$work/slurm.conf" <<CONF
ClusterName=loopback
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
SlurmctldPort=16817
SlurmdPort=16818
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MailProg=/bin/true
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF="$work/slurm.conf"
# no controller is asked for: the plugin of version 1 then touches nothing, where that of version 2 wants systemd
echo "CgroupPlugin=cgroup/v1" >"$work/cgroup.conf"
sleep 1
slurmctld -D -f "$SLURM_CONF" &
started="$! $started"
sleep 2
slurmd -D -f "$SLURM_CONF" &
started="$! $started"
for _ in $(seq 30); do
    sinfo -h -o %T 2>/dev/null | grep -q idle && break
    sleep 1
done
sinfo

cat >"$work/short.toml" <<TOML
[motion]
path = "still"
duration = "300 s"
TOML
campaign="$program campaign --units 8 --hours 0.1 --scenario $work/short.toml"
cat >"$work/array.sh" <<JOB
#!/bin/sh
#SBATCH --array=1-4
#SBATCH --cpus-per-task=1
exec $campaign --shard "\$SLURM_ARRAY_TASK_ID/\$SLURM_ARRAY_TASK_COUNT" --out $work/results/shards
JOB
sbatch --wait --chdir "$work" --output "$work/job-%a.txt" "$work/array.sh"
cat "$work"/job-*.txt
"$program" campaign merge "$work/results/shards" --out "$work/results/merged" >/dev/null
$campaign --out "$work/results/whole" >/dev/null
for file in summary.json summary.txt filters.parquet parameters.parquet; do
    cmp "$work/results/whole/$file" "$work/results/merged/$file"
done
echo "four shards by Slurm and one go: the same to the bit"
