#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs missing packages of a bare Debian 12, builds a small path tracer and renders a first picture, out/path_tracer.png,
# then builds petzval and makes the gallery, out/index.html.
#
#   sh examples/run.sh [--build-only | --full]
#
# --full makes the gallery with large scenes and little noise, in out/full (two hours on two cores).
# The programs are in build/examples/. A second run makes only what is missing.
# BUILD_DIR=... builds elsewhere, OUT_DIR=... renders elsewhere. UNITY=OFF compiles the sources separately.
set -eu
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd)
. "$root/cmake/build.sh"

render=yes
full=
case ${1-} in
  '') ;;
  --build-only) render=no ;;
  --full) full=--full ;;
  *) echo "usage: sh examples/run.sh [--build-only | --full]" >&2; exit 2 ;;
esac

need $library_packages $example_packages
out=${OUT_DIR:-$root/out}
if [ "$render" = yes ] && [ ! -f "$out/path_tracer.png" ]; then
  target=path_tracer
  build $unity -DPETZVAL_BUILD_TESTS=OFF -DPETZVAL_BUILD_EXAMPLES=ON
  mkdir -p "$out"
  "$BUILD_DIR/examples/path_tracer" "$out"
  echo "== The first picture: $out/path_tracer.png. Building petzval for the gallery."
fi
target=all
build $unity -DPETZVAL_BUILD_TESTS=OFF -DPETZVAL_BUILD_EXAMPLES=ON
[ "$render" = yes ] || exit 0
exec sh "$root/examples/gallery.sh" "$BUILD_DIR/examples" "$out" $full
