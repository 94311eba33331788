#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Computes a set of PSFs with GNU parallel: one shard at a time on each machine, because psf_set uses all processors.
# PARALLEL='--sshlogin a,b' names the machines; OUT must be a shared folder. PROGRAM=bokeh_scene renders a picture instead.
#
#   sh examples/farm/psf_set.parallel.sh 8 OUT LENS --fields 0,10 --at 1000,inf
#   PROGRAM=bokeh_scene sh examples/farm/psf_set.parallel.sh 8 OUT --scene chess --lens LENS --focus 950 --spp 256
set -eu
shards=$1
out=$2
shift 2
program=${PROGRAM:-psf_set}
case $program in
  bokeh_scene) shard=--shard whole=$out ;;
  *) shard=--shard whole=$out/psf_set.exr ;;
esac
parallel --will-cite --quote --jobs 1 --halt now,fail=1 "$program" "$@" $shard "{}/$shards" --resume --out "$out" ::: $(seq "$shards")
exec "$program" merge "$out" --out "$whole"
