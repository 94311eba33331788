#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Changes single places of the library, one after the other, and counts which changes the tests notice. Prints a table of modules
# and every change that no test noticed; fails where they notice less than 90 % of those that change what the library says.
#
#   sh tests/mutate.sh [--seed S] [--count N] [--modules focus,iris] [--jobs J]
#
# A sample of N places (60), the same for the same seed (1) and sources. The work is done in a copy of the tree, in
# build/mutants or MUTATE_DIR=..., by J compilers at a time. tests/mutants.txt has the changes that change nothing, with the reason.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
BUILD_DIR=${MUTATE_DIR:-$root/build/mutants}
. "$root/cmake/build.sh"

need $library_packages $test_packages git python3
exec python3 "$root/tests/mutate.py" "$root" "$BUILD_DIR" "$@"
