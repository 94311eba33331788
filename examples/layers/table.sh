#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Times, memory and quality of the lens blur for five scenes and two pupils, as a table in Markdown:
#   sh examples/layers/table.sh build/examples/petzval out/layers/table [WIDTHxHEIGHT]
# Reference: the same rays traced through the scene, small lights included. Memory: the layers.
set -eu
petzval=$1 out=$2 size=${3:-512x384}
echo "| scene | pupil (mm) | layers | peel (ms) | N-buffers (ms) | rays (ms) | reference (ms) | PSNR (dB) | SSIM | memory (MB) |"
echo "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|"
for scene in town statues knot leaves street; do
  for pupil in 18 100; do
    "$petzval" blur --scene $scene --thin-lens 50 --f-number "$(awk "BEGIN { print 50 / $pupil }")" --focus 5000 --rays 256 \
      --highlights-above 0 --supersample 1 --size "$size" --compare --format png --out "$out/${scene}_$pupil" > /dev/null
    awk -F '[":, ]+' -v row="| $scene | $pupil" '{ value[$2] = $3 } END {
      printf "%s | %d | %.0f | %.1f | %.0f | %.0f | %.1f | %.3f | %.1f |\n", row, value["layers"], value["peel_ms"],
        value["nbuffer_ms"], value["gather_ms"], value["reference_ms"], value["psnr_db"], value["ssim"], value["memory_mb"]
    }' "$out/${scene}_$pupil/blur.json"
  done
done
