#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Renders the gallery with the example programs: bokeh after figure 7 of Wu et al. 2010, its colours, irises with blades,
# an expressive lens, PSFs, spot diagrams, reports of twelve lenses, camera rays, tilted films, a focus pull, a focal surface,
# scenes through lenses, lens blur from layers, and index.html.
#
#   sh examples/gallery.sh PROGRAMS OUT [--full]    (examples/run.sh calls it with build/examples and out)
#
# --full: large pictures of the scenes with little noise (an hour on two cores).
set -eu
if [ $# -lt 2 ] || [ $# -gt 3 ] || { [ $# -eq 3 ] && [ "$3" != --full ]; }; then
  echo "usage: sh examples/gallery.sh PROGRAMS OUT [--full]" >&2
  exit 2
fi
programs=$1
out=$2
full=${3-}
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
lenses=$here/../data/lenses
mkdir -p "$out"

echo "== Figure 7 of Wu et al. 2010 (1/12)"
"$programs/wu_figure7" --criterion min_rms --out "$out/wu_figure7.png"
"$programs/wu_figure7" --criterion paraxial --out "$out/wu_figure7_paraxial.png"

echo "== The statements of the paper, by number (2/12)"
"$programs/wu_statements" --html "$out/wu_statements.html" > "$out/wu_statements.txt"
echo "$out/wu_statements.txt"

echo "== Bokeh off axis, in colour (3/12)"
"$programs/petzval" psf "$lenses/double_gauss_100mm_f1.35.json" --at 1000 \
  --focus 800,900,1000,1100,1200 --criterion paraxial --fields 8 --wavelengths "$(seq -s , 430 10 670)" --rays 262144 \
  --out "$out/bokeh"

echo "== The colours of bokeh (4/12)"
mkdir -p "$out/chromatic"
"$programs/petzval" colour "$lenses/double_gauss_100mm_f1.35.json" --rays 131072 --out "$out/chromatic" \
  > "$out/chromatic/chromatic_bokeh.txt"
echo "$out/chromatic"

echo "== Irises, cat's eyes, weights, an expressive lens, and a set of PSFs (5/12)"
"$programs/petzval" shapes --out "$out/bokeh"
"$programs/petzval" expressive "$lenses/double_gauss_100mm_f1.35.json" --focus 1000 --rays 65536 --out "$out/expressive"
"$programs/petzval" psf-set "$lenses/double_gauss_100mm_f2_28deg.json" --fields 0,5,10,14 --at 1000,1400,2000,4000,inf \
  --focus 2000 --out "$out/psf_set"

echo "== Spot diagrams of five lenses (6/12)"
# spots LENS FIELDS WAVELENGTHS
spots() {
  "$programs/petzval" spots "$lenses/$1.json" --fields "$2" --wavelengths "$3" --out "$out/spots"
}
f_d_c=486.1327,587.5618,656.2725  # the spectral lines F, d and C (nm)
spots double_gauss_100mm_f1.35 0,7,12 $f_d_c
spots double_gauss_100mm_f2_28deg 0,10,14 $f_d_c
spots cooke_triplet_50mm_f5 0,14,20 $f_d_c
spots petzval_portrait_100mm_f3.4 0,7,12 $f_d_c
spots fisheye_10mm_f4 0,40,70 587.5618

echo "== Reports of twelve lenses (7/12)"
for lens in petzval_portrait_100mm_f3.4 cooke_triplet_50mm_f5 planar_1896_f4.5 tessar_100mm_f5.5_1902 \
  sonnar_180mm_f2.8 biogon_35mm_f2.8 telephoto_250mm_f5.6 retrofocus_100mm_f2 \
  catadioptric_mangin_1000mm_f7.5 anamorphic_60mm_2x modern_58mm_f0.95 fisheye_6.3mm_f2.8; do
  "$programs/petzval" report "$lenses/$lens.json" --out "$out/lenses"
done

echo "== Rays of a camera, by every model of its lens (8/12)"
mkdir -p "$out/camera_rays"
awk 'BEGIN {
  print "film_x_mm,film_y_mm,pupil_u,pupil_v,wavelength_nm"
  for (y = -12; y <= 12; y += 4) for (u = 0; u < 8; ++u) printf "%g,%g,%g,0.9,587.5618\n", 1.5 * y, y, (u + 0.5) / 8
}' > "$out/camera_rays/samples.csv"
for model in pinhole thin thin_two_disc thick polynomial_3 polynomial_5 polynomial_7 polynomial_9 polynomial_11 \
  exact_float exact_double; do
  "$programs/petzval" camera-rays "$lenses/double_gauss_100mm_f2.0.json" --table "$out/camera_rays/samples.csv" \
    --out "$out/camera_rays/$model.csv" --model $model --focus 3000 --f-number 2.8
done
echo "$out/camera_rays"

echo "== Accuracy and speed of the models, and the model for a scene (9/12)"
"$programs/petzval" models "$lenses/double_gauss_100mm_f2_28deg.json" --f-number 2 --out "$out/models" \
  > "$out/accuracy_speed.txt"
"$programs/petzval" choose "$lenses/double_gauss_100mm_f2_28deg.json" --f-number 2 --near 2000 --far inf \
  --budget 0.5 > "$out/choose_camera.txt"
echo "$out/accuracy_speed.txt"
echo "$out/choose_camera.txt"

echo "== Films tilted to points, a focus pull, and a focal surface (10/12)"
# tilted FOLDER SCENE OPTION...
tilted() {
  folder=$out/tilt/$1
  scene=$here/scenes/$2.json
  shift 2
  mkdir -p "$folder"
  "$programs/petzval" tilt "$lenses/double_gauss_100mm_f2_28deg.json" --f-number 4 --points "$scene" "$@" --out "$folder" \
    > "$folder/tilt_shift.txt"
  echo "$folder"
}
tilted table table
tilted facade facade
tilted outlier facade_outlier
tilted robust facade_outlier --robust
mkdir -p "$out/focus_pull"
"$programs/petzval" pull "$lenses/double_gauss_100mm_f2_28deg.json" --f-number 2 --keys "$here/scenes/rack.json" \
  --out "$out/focus_pull" > "$out/focus_pull/focus_pull.txt"
echo "$out/focus_pull"
"$programs/petzval" surface "$lenses/double_gauss_52mm_f1.8.json" --points "$here/scenes/statues_focus.json" --size 600x400 \
  --focus 1500 --out "$out/focal_surface"

echo "== Scenes through lenses (11/12)"
mkdir -p "$out/scenes"
scenes_file=$out/scenes/scenes.html
if "$programs/petzval" help render > "$out/scenes/log.txt" 2>&1; then
  # scene FOLDER SCENE LENS SPP WIDTH HEIGHT OPTION...; --full: twice the size, sixteen times the samples
  scene() {
    folder=$out/scenes/$1 name=$2 lens=$3 spp=$4 width=$5 height=$6
    shift 6
    resume=
    rm -f "$folder/sums.exr"
    if [ -n "$full" ]; then
      folder=${folder}_large resume=--resume
      spp=$((16 * spp)) width=$((2 * width)) height=$((2 * height))
    fi
    "$programs/petzval" render "$lenses/$lens.json" --scene "$name" --spp "$spp" --size "${width}x${height}" \
      $resume --out "$folder" "$@" > "$out/scenes/log.txt"
    scenes="$scenes $folder"
  }
  wu="double_gauss_100mm_f1.35 double_gauss_100mm_f1.7_substitute double_gauss_100mm_f2_28deg"
  scenes=
  for lens in $wu; do
    for focus in 800 900 1000 1100 1200; do
      scene "balls_${lens}_$focus" balls "$lens" 128 600 80 --focus $focus --integrator path --film 36x4.8
    done
  done
  "$programs/petzval" sheet --columns 5 --title "A row of balls, after figure 8 of Wu et al. 2010" --out "$out/scenes/balls.png" \
    --balls "$out/scenes/balls.csv" $scenes
  scenes=
  scene chess_pinhole chess double_gauss_100mm_f2_28deg 32 480 320 --focus 880 --model pinhole
  for lens in $wu; do scene "chess_$lens" chess "$lens" 32 480 320 --focus 880; done
  "$programs/petzval" sheet --columns 2 --title "Chess, after figure 9 of Wu et al. 2010" --out "$out/scenes/chess.png" $scenes
  scenes=
  # Distances in scenes count from the entrance pupil.
  scene street street double_gauss_100mm_f2_28deg 48 480 320 --focus 3000 --from entrance_pupil
  "$programs/petzval" sheet --title "A street at night" --out "$out/scenes/street.png" $scenes
  scenes=
  statues="--from entrance_pupil --integrator path"
  # shellcheck disable=SC2086
  scene statues_near statues double_gauss_52mm_f1.8 32 450 300 --focus 1500 $statues
  # shellcheck disable=SC2086
  scene statues_far statues double_gauss_52mm_f1.8 32 450 300 --focus 6000 $statues
  # shellcheck disable=SC2086
  scene statues_both statues double_gauss_52mm_f1.8 32 450 300 --focus 1500 $statues --model thin_two_disc \
    --focal-surface "$here/scenes/statues_focus.json"
  "$programs/petzval" sheet --columns 3 --title "Two statues, after figure 1 (d) of Lee et al. 2010" \
    --out "$out/scenes/statues.png" $scenes
  scenes=
  for lens in "" "--curvature-points 0,0:0 18,0:3 -18,0:3 0,12:1.5 0,-12:1.5"; do
    # shellcheck disable=SC2086
    scene "table_$(echo "$lens" | wc -w)" chess double_gauss_100mm_f2_28deg 32 450 300 --focus 920 --tilt 12 \
      --model thick --integrator path $lens
  done
  "$programs/petzval" sheet --columns 2 --title "Curvature of field on a tilted film, after figure 6 of Lee et al. 2010" \
    --out "$out/scenes/table.png" $scenes

  echo "== Lens blur from layers (12/12)"
  # blur FOLDER SCENE OPTION...
  blur() {
    folder=$out/layers/$1 name=$2
    shift 2
    "$programs/petzval" blur --scene "$name" --format png "$@" --out "$folder" > "$out/scenes/log.txt"
    echo "$folder"
  }
  blur thin town --thin-lens 50 --f-number 0.5 --focus 5000
  blur singlet town --singlet 51.68,-51.68,8,N-BK7 --f-number 2 --focus 5000 --fov 30
  blur chroma town --singlet 51.68,-51.68,8,N-BK7 --f-number 2 --focus 5000 --fov 30 --wavelengths rgb
  blur tilt town --thin-lens 50 --f-number 1.25 --focus 5000 --tilt 6
  blur knot knot --thin-lens 50 --f-number 0.5 --focus 3600
  blur leaves leaves --thin-lens 50 --f-number 0.5 --focus 5000 --layers 8
  blur cats_eyes statues "$lenses/double_gauss_100mm_f1.35.json" --focus 3000 --from entrance_pupil --fov 22
  blur surface statues --thin-lens 50 --f-number 1.79 --focus 5000 --points "$here/scenes/statues_focus.json"
  blur night street --thin-lens 100 --f-number 2 --focus 3000 --fov 14 --blades 6
  cp "$here/scenes.html" "$scenes_file"
else
  echo "petzval render was not built: no Embree (libembree-dev, libtinyobjloader-dev)"
  echo "<p>petzval render was not built: it needs Embree and tinyobjloader.</p>" > "$scenes_file"
fi

sed -e "/@statements@/r $out/wu_statements.html" -e "/@statements@/d" -e "/@scenes@/r $scenes_file" -e "/@scenes@/d" \
  "$here/gallery.html" > "$out/index.html"
echo "== Done: open $out/index.html"
