#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Counts which lines and branches of include and lib the tests run. Prints a table of modules, the lines that report errors and
# never ran, and the totals; fails below 95 % of lines or 85 % of branches, and where an importer has an error that no test sees.
# Code that is inlined at each call and compiled for each instruction set has branches in each copy: these count apart.
#
#   sh tests/coverage.sh [arguments of ctest]
#
# COVERAGE_DIR=... builds elsewhere than in build/coverage/; its report/index.html shows every line.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
BUILD_DIR=${COVERAGE_DIR:-$root/build/coverage}
. "$root/cmake/build.sh"

need $library_packages $example_packages $test_packages gcovr
# Calls that are inlined would be counted where they are inlined; updates from threads would be lost.
build -DPETZVAL_BUILD_TESTS=ON -DPETZVAL_BUILD_EXAMPLES=ON -DCMAKE_BUILD_TYPE=Debug \
  "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -fno-inline-functions" "-DCMAKE_CXX_FLAGS=--coverage -fprofile-update=atomic"
find "$BUILD_DIR" -name '*.gcda' -delete
echo "== Testing"
ctest --test-dir "$BUILD_DIR" -j "$(nproc)" --no-tests=error --output-on-failure -E '^(house|packaging)' "$@" || failed=1

echo "== Counting"
mkdir -p "$BUILD_DIR/report"
cd "$root"
# Branches that only an exception takes are the compiler's, not the author's.
gcovr -j "$(nproc)" --root "$root" --object-directory "$BUILD_DIR" --filter "$root/include/" --filter "$root/lib/" \
  --exclude-throw-branches --exclude-unreachable-branches --gcov-ignore-parse-errors \
  --json "$BUILD_DIR/report/coverage.json" --html-details "$BUILD_DIR/report/index.html" "$BUILD_DIR" >/dev/null
python3 "$root/tests/coverage.py" "$BUILD_DIR/report/coverage.json" "$root"
exit "${failed:-0}"
