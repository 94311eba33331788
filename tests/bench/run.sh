#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the benchmarks and prints their tables; the tables take two minutes.
#
#   sh tests/bench/run.sh [--isa baseline|avx2|avx512] [options of Google Benchmark]
#
# --isa selects the only instruction set of the batches of trace_bench.
# BUILD_DIR=... replaces build/.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
. "$root/cmake/build.sh"

need $library_packages $example_packages libbenchmark-dev
target=benches
build -DPETZVAL_BUILD_BENCHMARKS=ON -DPETZVAL_BUILD_TESTS=OFF -DPETZVAL_BUILD_EXAMPLES=ON
echo
"$BUILD_DIR/tests/bench/trace_bench" "$@"

# Only trace_bench has this option.
left=$#
while [ "$left" -gt 0 ]; do
  case $1 in
    --isa) shift 2; left=$((left - 2)) ;;
    *) set -- "$@" "$1"; shift; left=$((left - 1)) ;;
  esac
done
for bench in camera host pupil psf surface movement; do
  [ -x "$BUILD_DIR/tests/bench/${bench}_bench" ] || continue  # movement_bench needs Ceres
  echo
  "$BUILD_DIR/tests/bench/${bench}_bench" "$@"
done
if [ -x "$BUILD_DIR/tests/bench/blur_bench" ]; then  # needs Embree
  echo
  "$BUILD_DIR/tests/bench/blur_bench"
fi
