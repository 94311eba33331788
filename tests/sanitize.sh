#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds everything with sanitizers and runs the tests: AddressSanitizer, UndefinedBehaviorSanitizer and libstdc++'s assertions
# (the preset asan), then ThreadSanitizer (tsan). Any report fails its test. CMakePresets.json has the flags.
#
#   sh tests/sanitize.sh [asan] [tsan] [-- arguments of ctest, such as -R Camera]
#
# Division of floating-point numbers by zero is not trapped: it has a defined result, which planes (1/0 = infinite radius) and
# rays that are parallel to a plane use on purpose.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
. "$root/cmake/build.sh"

presets=
while [ $# -gt 0 ]; do
  case $1 in
    asan | tsan) presets="$presets $1" ;;
    --) shift; break ;;
    *) echo "tests/sanitize.sh: found $1, wanted asan, tsan or --" >&2; exit 2 ;;
  esac
  shift
done

need $library_packages $example_packages $test_packages
export ASAN_OPTIONS=detect_stack_use_after_return=1:check_initialization_order=1:strict_string_checks=1:allocator_may_return_null=1
export "LSAN_OPTIONS=print_suppressions=0 suppressions=$root/tests/lsan.supp"
export UBSAN_OPTIONS=print_stacktrace=1
export "TSAN_OPTIONS=halt_on_error=1 suppressions=$root/tests/tsan.supp"
cd "$root"
for preset in ${presets:-asan tsan}; do
  echo "== Building with $preset"
  cmake --preset "$preset"
  cmake --build --preset "$preset"
  echo "== Testing with $preset"
  # The source tree and the installed tree are the same in every build.
  ctest --preset "$preset" -j "$(nproc)" --no-tests=error -E '^(house|packaging)' "$@"
done
