#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Mutation tests: makes single changes to the sources of the library, one at a time, and counts the changes that a test detects.
# Prints a table of modules and every undetected change. Fails if less than 90 % of the changes with an effect are detected.
#
#   sh tests/mutate.sh [--seed S] [--count N] [--modules focus,iris] [--jobs J]
#
# Takes a random sample of N changes (default 60), which depends only on the seed (default 1) and the sources. Works in a copy of
# the tree, in build/mutants or MUTATE_DIR=..., with J compilers at a time. tests/mutants.txt lists changes without effect, with
# reasons.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
BUILD_DIR=${MUTATE_DIR:-$root/build/mutants}
. "$root/cmake/build.sh"

need $library_packages $test_packages git python3
exec python3 "$root/tests/mutate.py" "$root" "$BUILD_DIR" "$@"
