#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the tests of reproducible bits with each installed compiler, with and without optimisation, and runs them on every
# instruction set of this processor. The hashes are constants, so that each run is compared with all others.
#
#   sh tests/bits/run.sh [g++-O0] [g++-O3] [clang++-O0] [clang++-O3]
#
# BITS_DIR=... replaces build/bits/. tests/platforms/run.sh runs the same tests on other processors and systems.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
. "$root/cmake/build.sh"
work=${BITS_DIR:-$root/build/bits}
[ $# -gt 0 ] || set -- g++-O0 g++-O3 clang++-O0 clang++-O3

need $library_packages $test_packages
for way; do
  compiler=${way%-O*}
  case $way in
    g++-O[0-3]) ;;
    clang++-O[0-3]) compiler=$(command -v clang++-14 || command -v clang++ || true) ;;
    *) echo "tests/bits/run.sh: compiler = $way; must be g++-O0 to g++-O3 or clang++-O0 to clang++-O3" >&2; exit 2 ;;
  esac
  if [ -z "$compiler" ]; then
    echo "== $way: clang++ is not installed, skipped"
    continue
  fi
  BUILD_DIR=$work/$way
  target=bits_tests
  build -DPETZVAL_BUILD_EXAMPLES=OFF -DPETZVAL_WITH_CERES=OFF -DPETZVAL_WITH_OPENEXR=OFF "-DCMAKE_CXX_COMPILER=$compiler" \
    -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=-${way##*-}"
  for set in baseline avx2 avx512; do
    echo "== $way, $set at the widest"
    PETZVAL_INSTRUCTION_SET=$set "$BUILD_DIR/tests/bits/bits_tests" --gtest_brief=1
  done
done
