#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Compiles and runs host.c and host17.cpp in all languages that may call the C interface, with each compiler found.
#
#   sh standards.sh INCLUDE LIBRARY_FOLDER LENS
set -eu
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
include=$1 libraries=$2 lens=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
warnings="-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror"

# run NAME COMMAND...: compiles to $work/host and runs it. All programs of one source must print the same.
run() {
  name=$1 source=$2
  shift 2
  "$@" $warnings -I "$include" -o "$work/host" "$source" -L "$libraries" -Wl,-rpath,"$libraries" -Wl,-rpath-link,"$libraries" \
    -lpetzval-c -lm
  "$work/host" "$lens" >"$work/out" || { echo "$name fails:"; cat "$work/out"; exit 1; }
  first=$work/$(basename "$source").first
  [ -e "$first" ] || cp "$work/out" "$first"
  cmp "$work/out" "$first" || { echo "$name prints something else:"; cat "$work/out" "$first"; exit 1; }
  echo "$name: $(cat "$work/out")"
}
for compilers in "gcc g++" "clang-14 clang++-14"; do
  c=${compilers% *} cxx=${compilers#* }
  command -v "$c" >/dev/null || continue
  for standard in c99 c11; do run "$c $standard" "$here/host.c" "$c" -x c -std=$standard; done
  for standard in c++11 c++14 c++17; do
    run "$cxx $standard" "$here/host.c" "$cxx" -x c++ -std=$standard -fno-exceptions -fno-rtti
    run "$cxx $standard" "$here/host17.cpp" "$cxx" -x c++ -std=$standard -fno-exceptions -fno-rtti
  done
done
