#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the benchmarks and prints their tables; under a minute when built.
#
#   sh tests/bench/run.sh [--benchmark_filter=... and other options of Google Benchmark]
#
# BUILD_DIR=... builds elsewhere than in build/.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
. "$root/cmake/build.sh"

need $library_packages libbenchmark-dev
build -DPETZVAL_BUILD_BENCHMARKS=ON -DPETZVAL_BUILD_TESTS=OFF -DPETZVAL_BUILD_EXAMPLES=OFF
for bench in trace pupil psf; do
  echo
  "$BUILD_DIR/tests/bench/${bench}_bench" "$@"
done
