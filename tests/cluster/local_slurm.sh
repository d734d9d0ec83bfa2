#!/bin/bash
# Slurm on this one machine, without system services: local_slurm.sh up FOLDER | down FOLDER
# Debian and Ubuntu: apt-get install --no-install-recommends slurm-wlm munge
# After `up`, source FOLDER/environment.
set -euo pipefail
action=$1 folder=$(realpath -m "$2")

up() {
    mkdir -p "$folder"/{state,spool,log,run,bin}
    chmod 700 "$folder"
    local host user
    host=$(hostname -s) user=$(id -un)
    (umask 077; head -c 1024 /dev/urandom > "$folder/munge.key")
    cat > "$folder/slurm.conf" <<CONF
ClusterName=local
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/run/munge.sock
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/run/slurmctld.pid
SlurmdPidFile=$folder/run/slurmd.pid
SlurmctldLogFile=$folder/log/slurmctld.log
SlurmdLogFile=$folder/log/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=bf_interval=1,sched_interval=1,batch_sched_delay=0
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
DefMemPerCPU=500
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=1
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
MinJobAge=300
KillWait=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$(($(free -m | awk '/^Mem:/ {print $2}') * 8 / 10)) State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
    munged --force --key-file="$folder/munge.key" --socket="$folder/run/munge.sock" \
        --pid-file="$folder/run/munged.pid" --log-file="$folder/log/munged.log" \
        --seed-file="$folder/run/munged.seed"
    export SLURM_CONF=$folder/slurm.conf
    slurmctld -i
    slurmd -N "$host"
    # A job's own srun does not inherit SLURM_CONF.
    printf '#!/bin/sh\nexec env SLURM_CONF=%s %s "$@"\n' "$SLURM_CONF" "$(command -v srun)" \
        > "$folder/bin/srun"
    chmod +x "$folder/bin/srun"
    printf 'export SLURM_CONF=%s\nexport PATH=%s:$PATH\n' "$SLURM_CONF" "$folder/bin" \
        > "$folder/environment"
    for _ in $(seq 100); do
        sinfo --noheader --format %T | grep -q idle && return
        sleep 0.1
    done
    echo "the node did not come up; see $folder/log" >&2
    exit 1
}

down() {
    for name in slurmd slurmctld munged; do
        if [ -f "$folder/run/$name.pid" ]; then
            kill "$(cat "$folder/run/$name.pid")" || true
        fi
    done
}

"$action"
