#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Computes a set of PSFs with GNU parallel: one shard at a time on each machine, because petzval uses all processors.
# PARALLEL='--sshlogin a,b' names the machines; OUT must be a shared folder. COMMAND=render renders a picture instead.
# PETZVAL=... is the path of the program.
#
#   sh examples/farm/psf_set.parallel.sh 8 OUT LENS --fields 0,10 --at 1m,inf
#   COMMAND=render sh examples/farm/psf_set.parallel.sh 8 OUT LENS --scene chess --focus 950 --spp 256
set -eu
shards=$1
out=$2
shift 2
petzval=${PETZVAL:-petzval}
command=${COMMAND:-psf-set}
whole=$out
[ "$command" = render ] || whole=$out/psf_set.exr
parallel --will-cite --quote --jobs 1 --halt now,fail=1 "$petzval" "$command" "$@" --shard "{}/$shards" --resume --out "$out" \
  ::: $(seq "$shards")
exec "$petzval" "$command" merge "$out" --out "$whole"
