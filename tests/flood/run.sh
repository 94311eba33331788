#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds and runs flood: by default 1e9 random rays, 1e8 camera samples and 1e7 blurred pixels.
#
#   sh tests/flood/run.sh [--rays N] [--samples N] [--gathers N] [--seed S] [--from CASE] [--threads N]
#
# BUILD_DIR=... replaces build/.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
. "$root/cmake/build.sh"

need $library_packages $example_packages $test_packages
target=flood
build -DPETZVAL_BUILD_TESTS=ON -DPETZVAL_BUILD_EXAMPLES=ON
exec "$BUILD_DIR/tests/flood/flood" "$@"
