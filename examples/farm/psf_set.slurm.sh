#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Computes a set of PSFs as a Slurm array, one task for each shard; OUT must be a shared folder. COMMAND=render
# renders a picture instead. PETZVAL=... is the path of the program.
#
#   job=$(sbatch --parsable --array=1-8 examples/farm/psf_set.slurm.sh OUT LENS --fields 0,10 --at 1000,inf)
#   sbatch --dependency=afterok:$job --wrap 'petzval psf-set merge OUT --out OUT/psf_set.exr'
#
#   job=$(COMMAND=render sbatch --parsable --array=1-8 examples/farm/psf_set.slurm.sh OUT LENS --scene chess --focus 950 --spp 256)
#   sbatch --dependency=afterok:$job --wrap 'petzval render merge OUT --out OUT'
#
# An interrupted task continues from its files when it is queued again: scontrol requeue $job
#SBATCH --job-name=psf_set
#SBATCH --requeue
set -eu
if [ "${SLURM_ARRAY_TASK_MIN:-}" != 1 ] || [ "${SLURM_ARRAY_TASK_MAX:-}" != "${SLURM_ARRAY_TASK_COUNT:-}" ]; then
  echo "psf_set.slurm.sh: array = ${SLURM_ARRAY_TASK_MIN:-}-${SLURM_ARRAY_TASK_MAX:-}; must be set by --array=1-N" >&2
  exit 2
fi
out=$1
shift
exec "${PETZVAL:-petzval}" "${COMMAND:-psf-set}" "$@" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --resume --out "$out"
