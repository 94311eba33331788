#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the benchmarks and prints their tables; two minutes when built.
#
#   sh tests/bench/run.sh [--json FILE] [--isa baseline|avx2|avx512] [--benchmark_filter=... and others of the library]
#
# --json writes the rows of the trace as an array of objects, --isa measures its batches on one instruction set alone.
# BUILD_DIR=... builds elsewhere than in build/.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
. "$root/cmake/build.sh"

need $library_packages $example_packages libbenchmark-dev
target=benches
build -DPETZVAL_BUILD_BENCHMARKS=ON -DPETZVAL_BUILD_TESTS=OFF -DPETZVAL_BUILD_EXAMPLES=ON
echo
"$BUILD_DIR/tests/bench/trace_bench" "$@"

# What the trace alone knows is taken out for the others.
left=$#
while [ "$left" -gt 0 ]; do
  case $1 in
    --json | --isa) shift 2; left=$((left - 2)) ;;
    *) set -- "$@" "$1"; shift; left=$((left - 1)) ;;
  esac
done
for bench in camera pupil psf surface movement; do
  [ -x "$BUILD_DIR/tests/bench/${bench}_bench" ] || continue  # movement: built with Ceres alone
  echo
  "$BUILD_DIR/tests/bench/${bench}_bench" "$@"
done
if [ -x "$BUILD_DIR/tests/bench/blur_bench" ]; then  # built with Embree alone
  echo
  "$BUILD_DIR/tests/bench/blur_bench"
fi
