#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds petzval and runs its tests. Installs missing packages on Debian 12.
#
#   sh tests/run.sh [arguments of ctest, such as -R Snell]    the tests of the library
#   sh tests/run.sh -L full      the tests of programs, packages and fuzz targets, and the build of the benchmarks; clang, if installed, compiles all sources
#   sh tests/run.sh --report    prints the tables of tests/README.md: worst cases of the accuracy tests
#
# BUILD_DIR=... replaces build/. UNITY=OFF compiles the sources separately, which is faster after a change of one source.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
. "$root/cmake/build.sh"

# table COLUMNS MODULE/CASES...: prints the values that these cases report (tests/report.hpp), one row per name. COLUMNS are
# separated by ";"; the key of a column ends at a comma, its heading does not.
table() {
  columns=$1
  shift
  files=
  for cases; do
    module=${cases%%/*}
    file=$work/$#.xml
    files="$files $file"
    "$BUILD_DIR/tests/$module/${module}_tests" "--gtest_filter=${cases#*/}" "--gtest_output=xml:$file" >"$work/log" ||
      { cat "$work/log" >&2; exit 1; }
    shift
  done
  awk -F '"' -v list="$columns" '
    BEGIN {
      count = split(list, columns, ";")
      head = "\n| case |"; line = "|---|"
      for (c = 1; c <= count; ++c) { head = head " " columns[c] " |"; line = line "---|"; sub(/,.*/, "", columns[c]) }
      print head " bound |\n" line "---|"
    }
    /<property name=".* [|] / {
      split($2, key, " [|] ")
      if (!(key[1] in bound)) { row[++rows] = key[1]; bound[key[1]] = key[3] }
      else if (index(bound[key[1]], key[3]) == 0) bound[key[1]] = bound[key[1]] ", " key[3]
      cell[key[1], key[2]] = $4
    }
    END {
      for (i = 1; i <= rows; ++i) {
        line = "| " row[i] " |"
        for (c = 1; c <= count; ++c) line = line " " cell[row[i], columns[c]] " |"
        print line " " bound[row[i]] " |"
      }
    }' $files
}

case " $* " in
  *" -L full "*) full=ON target=all ;;
  *) full=OFF target=petzval-tests example_packages= full_packages= ;;
esac
need $library_packages $example_packages $test_packages $full_packages
build $unity -DPETZVAL_BUILD_TESTS=ON -DPETZVAL_FULL_TESTS=$full -DPETZVAL_BUILD_EXAMPLES=$full -DPETZVAL_BUILD_BENCHMARKS=$full -DCMAKE_COMPILE_WARNING_AS_ERROR=ON
if [ "${1-}" = --report ]; then
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  by_type='float;double;batch float, fast / reproducible;batch double, fast / reproducible'
  printf '\nAccuracy'
  table "$by_type" 'lens/Quadric*' 'lens/Snell*' 'trace/ReferenceRays*' 'trace/BatchReference*' \
    'trace/Laws*' 'trace/DifferentialsOf*EqualsExactRays' \
    'trace/DifferentialsOf*-*EqualsExactRays' 'pupil/Aim*'
  printf '\nLimits'
  table "$by_type" 'trace/Extremes*'
  printf '\nMemory'
  table 'text, MB;memory, MB' 'formats/LargestInputs*'
  exit
fi
echo "== Testing"
exec ctest --test-dir "$BUILD_DIR" -j "$(nproc)" --timeout 900 --output-on-failure --no-tests=error "$@"
