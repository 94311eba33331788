#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds everything with sanitizers and runs the tests: AddressSanitizer, UndefinedBehaviorSanitizer and libstdc++'s assertions
# (asan), then ThreadSanitizer (tsan), in asan/ and tsan/ of build/ or BUILD_DIR=... Any report fails its test.
#
#   sh tests/sanitize.sh [asan] [tsan] [-- arguments of ctest, such as -R Camera]
#
# Floating-point division by zero is allowed: its result is defined, and planes (1/0 = infinite radius) and rays parallel to a
# plane depend on it.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
. "$root/cmake/build.sh"

kinds=
while [ $# -gt 0 ]; do
  case $1 in
    asan | tsan) kinds="$kinds $1" ;;
    --) shift; break ;;
    *) echo "tests/sanitize.sh: sanitizer = $1; must be asan, tsan or --" >&2; exit 2 ;;
  esac
  shift
done

need $library_packages $example_packages $test_packages $full_packages
export ASAN_OPTIONS=detect_stack_use_after_return=1:check_initialization_order=1:strict_string_checks=1:allocator_may_return_null=1
export UBSAN_OPTIONS=print_stacktrace=1
export "TSAN_OPTIONS=halt_on_error=1 suppressions=$root/tests/tsan.supp"
BUILD_ROOT=$BUILD_DIR
for kind in ${kinds:-asan tsan}; do
  case $kind in
    asan)
      flags="-fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=undefined,float-cast-overflow"
      flags="$flags -D_GLIBCXX_ASSERTIONS"
      ;;
    tsan) flags=-fsanitize=thread ;;
  esac
  echo "== $kind"
  BUILD_DIR=$BUILD_ROOT/$kind
  build -DCMAKE_BUILD_TYPE=RelWithDebInfo "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -g1" "-DCMAKE_CXX_FLAGS=$flags"
  echo "== Testing"
  # Sanitizers do not change the source tree and the installed tree.
  ctest --test-dir "$BUILD_DIR" -j "$(nproc)" --output-on-failure --no-tests=error -E '^(house|packaging)' "$@"
done
