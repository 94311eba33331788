#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Prints the worst case that each accuracy test measured: the numbers of README's accuracy table. Run tests/run.sh first.
#
#   sh tests/accuracy.sh
#
# BUILD_DIR=... looks elsewhere than in build/.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
build=${BUILD_DIR:-$root/build}
results=$(mktemp)
trap 'rm -f "$results"' EXIT
for test in surface/surface_quadric surface/surface_asphere surface/surface_snell trace/trace_reference trace/trace_laws trace/trace_derivative \
  pupil/pupil_aim pupil/pupil_pupil_sampler psf/psf_psf; do
  "$build/tests/${test}_test" "--gtest_output=xml:$results" >/dev/null
  sed -n -e 's/.*<testcase name="\([^"]*\)".*type_param="\([^"]*\)".*classname="\([^"/]*\).*/\3.\1 (\2)/' -e 't keep' \
    -e 's/.*<testcase name="\([^"]*\)".*classname="\([^"]*\)".*/\2.\1/' -e 't keep' -e 'b value' -e ': keep' -e 'h' -e 'd' -e ': value' \
    -e 's/.*<property name="\([^"]*\)" value="\([^"]*\)".*/: \1 \2/' -e 't show' -e 'd' -e ': show' -e 'H' -e 'g' -e 's/\n//' -e 'p' \
    -e 's/: [a-z].*//' -e 'h' "$results"
done
