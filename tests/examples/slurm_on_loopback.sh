#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Starts Slurm for one command: one node on the loopback interface, as root, without authentication.
#
#   sh slurm_on_loopback.sh FOLDER COMMAND...
#
# FOLDER gets the state and the logs of Slurm. The exit status is the status of the command, or 77 if Slurm does not start.
set -eu
folder=$1
shift
mkdir -p "$folder/state" "$folder/spool"
port=$((20000 + $$ % 20000))
host=$(hostname -s)
cat > "$folder/slurm.conf" <<CONF
ClusterName=loopback
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
CryptoType=crypto/none
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc)
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF="$folder/slurm.conf"
slurmctld -D > "$folder/slurmctld.log" 2>&1 &
controller=$!
slurmd -D > "$folder/slurmd.log" 2>&1 &
node=$!
trap 'kill $node $controller 2> /dev/null; wait' EXIT
for second in $(seq 30); do
  kill -0 $controller $node 2> /dev/null || break
  if sinfo --noheader --states=idle 2> /dev/null | grep -q .; then
    status=0
    "$@" || status=$?
    exit $status
  fi
  sleep 1
done
cat "$folder/slurmctld.log" "$folder/slurmd.log" >&2
exit 77
