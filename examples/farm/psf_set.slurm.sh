#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A set of PSFs as a Slurm array, one task for each shard; OUT is a folder that all nodes see. PROGRAM=bokeh_scene makes
# a picture.
#
#   job=$(sbatch --parsable --array=1-8 examples/farm/psf_set.slurm.sh OUT LENS --fields 0,10 --distances-mm 1000,inf)
#   sbatch --dependency=afterok:$job --wrap 'psf_set merge OUT --out OUT/psf_set.exr'
#
#   job=$(PROGRAM=bokeh_scene sbatch --parsable --array=1-8 examples/farm/psf_set.slurm.sh OUT --scene chess --lens LENS --focus-mm 950 --spp 256)
#   sbatch --dependency=afterok:$job --wrap 'bokeh_scene merge OUT --out OUT'
#
# A task that was cut off goes on where its files end when it is queued again: scontrol requeue $job
#SBATCH --job-name=psf_set
#SBATCH --requeue
set -eu
if [ "${SLURM_ARRAY_TASK_MIN:-}" != 1 ] || [ "${SLURM_ARRAY_TASK_MAX:-}" != "${SLURM_ARRAY_TASK_COUNT:-}" ]; then
  echo "psf_set.slurm.sh: found an array from ${SLURM_ARRAY_TASK_MIN:-nothing} to ${SLURM_ARRAY_TASK_MAX:-nothing}, wanted --array=1-N" >&2
  exit 2
fi
out=$1
shift
program=${PROGRAM:-psf_set}
case $program in
  bokeh_scene) shard=--tile ;;
  *) shard=--shard ;;
esac
exec "$program" "$@" $shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --resume --out "$out"
