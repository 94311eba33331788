#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds petzval with its examples and runs the tests; installs what a bare Debian 12 lacks.
#
#   sh tests/run.sh [arguments of ctest, such as -R Snell]
#
# BUILD_DIR=... builds elsewhere than in build/.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
. "$root/cmake/build.sh"

need $library_packages $example_packages $test_packages
build -DPETZVAL_BUILD_TESTS=ON -DPETZVAL_BUILD_EXAMPLES=ON -DCMAKE_COMPILE_WARNING_AS_ERROR=ON
echo "== Testing"
exec ctest --test-dir "$BUILD_DIR" -j "$(nproc)" --output-on-failure "$@"
