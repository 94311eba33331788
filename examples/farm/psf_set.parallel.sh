#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A set of PSFs by GNU parallel: one shard at a time on each machine, for psf_set runs on all of its processors. Machines
# are named by PARALLEL='--sshlogin a,b'; OUT is a folder that all of them see.
#
#   sh examples/farm/psf_set.parallel.sh 8 OUT LENS.json --fields 0,10 --distances-mm 1000,inf
set -eu
shards=$1
out=$2
shift 2
parallel --will-cite --quote --jobs 1 --halt now,fail=1 psf_set "$@" --shard "{}/$shards" --resume --out "$out" ::: $(seq "$shards")
exec psf_set merge "$out" --out "$out/psf_set.exr"
