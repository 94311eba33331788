#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the example programs and renders the gallery. Installs missing packages of a bare Debian 12.
#
#   sh examples/run.sh [--build-only | --full]
#
# --full renders large scenes with little noise (an hour on two cores). Existing samples are kept.
# The programs are in build/examples/, the pictures in out/ (start with out/index.html).
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
build $unity -DPETZVAL_BUILD_TESTS=OFF -DPETZVAL_BUILD_EXAMPLES=ON
[ "$render" = yes ] || exit 0
exec sh "$root/examples/gallery.sh" "$BUILD_DIR/examples" "${OUT_DIR:-$root/out}" $full
