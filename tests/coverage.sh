#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Counts the lines and branches of include and lib that the tests run. Prints a table of modules, the untested lines that report
# errors, and the totals. Fails below 95 % of lines or 85 % of branches, and if no test triggers an error of an importer.
# The branches of code that is compiled once per call and instruction set are counted separately.
#
#   sh tests/coverage.sh [arguments of ctest]
#
# COVERAGE_DIR=... replaces build/coverage/; report/index.html in this folder shows every line.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
BUILD_DIR=${COVERAGE_DIR:-$root/build/coverage}
. "$root/cmake/build.sh"

need $library_packages $example_packages $test_packages $full_packages gcovr
# Inlined functions would be counted in their callers; non-atomic updates from threads would be lost.
build -DPETZVAL_BUILD_TESTS=ON -DPETZVAL_BUILD_EXAMPLES=ON -DCMAKE_BUILD_TYPE=Debug \
  "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -fno-inline-functions" "-DCMAKE_CXX_FLAGS=--coverage -fprofile-update=atomic"
find "$BUILD_DIR" -name '*.gcda' -delete
echo "== Testing"
ctest --test-dir "$BUILD_DIR" -j "$(nproc)" --no-tests=error --output-on-failure -E '^(house|packaging)' "$@" || failed=1

echo "== Counting"
mkdir -p "$BUILD_DIR/report"
cd "$root"
# The compiler adds a branch for exceptions to each call; these branches are not counted.
gcovr -j "$(nproc)" --root "$root" --object-directory "$BUILD_DIR" --filter "$root/include/" --filter "$root/lib/" \
  --exclude-throw-branches --exclude-unreachable-branches --gcov-ignore-parse-errors \
  --json "$BUILD_DIR/report/coverage.json" --html-details "$BUILD_DIR/report/index.html" "$BUILD_DIR" >/dev/null
python3 "$root/tests/coverage.py" "$BUILD_DIR/report/coverage.json" "$root"
exit "${failed:-0}"
