#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes the pictures of the chapter "Focus by clicking" in photographers.md; without a display on a virtual one (xvfb).
#
#   sh lib/docs/view/screenshots.sh build/examples/petzval out/view
set -eu
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
petzval=$1 out=$2
mkdir -p "$out"
shot() {
  name=$1
  shift
  set -- "$petzval" view --replay "$here/$name.json" --screenshot "$out/view_$name.png" "$@"
  if [ -n "${DISPLAY-}" ]; then "$@"; else xvfb-run -a -s '-screen 0 1280x1024x24' "$@"; fi
}
shot click
shot film --panels map,histogram
shot tilt --panels map
shot surface --panels map
shot bokeh --panels bokeh
shot keys --panels keys
