#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Times, memory and quality of the lens blur for five scenes and two pupils, as a table in Markdown:
#   sh examples/layers/table.sh build/examples/petzval out/layers/table [WIDTHxHEIGHT]
# 100 rays per pixel as in the paper, and small lights without discs. Reference: the same rays traced through the scene.
# Energy: light of the picture compared with the reference. Memory: the layers.
set -eu
petzval=$1 out=$2 size=${3:-800x600}
echo "| scene | pupil (mm) | layers | peel (ms) | N-buffers (ms) | rays (ms) | reference (ms) | PSNR (dB) | SSIM | energy (%) | memory (MB) |"
echo "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|"
for scene in town statues knot leaves street; do
  for pupil in 18 100; do
    "$petzval" blur --scene $scene --thin-lens 50 --f-number "$(awk "BEGIN { print 50 / $pupil }")" --focus 5000 --rays 100 \
      --highlights-above 0 --size "$size" --compare --format png --out "$out/${scene}_$pupil" > /dev/null
    awk -F '[":, ]+' -v row="| $scene | $pupil" '{ value[$2] = $3 } END {
      printf "%s | %d | %.0f | %.1f | %.0f | %.0f | %.1f | %.3f | %+.2f | %.1f |\n", row, value["layers"], value["peel_ms"],
        value["nbuffer_ms"], value["gather_ms"], value["reference_ms"], value["psnr_db"], value["ssim"],
        100 * value["energy_drift"], value["memory_mb"]
    }' "$out/${scene}_$pupil/blur.json"
  done
done
