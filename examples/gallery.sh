#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes the gallery: pictures of all commands of petzval, with their commands and times, in one page.
#
#   sh examples/gallery.sh PROGRAMS OUT [--full]    (examples/run.sh calls it with build/examples and out)
#
# Keeps pictures of an earlier run whose commands are the same. --full: scenes twice as large with four times the samples, in
# OUT/full (two hours on two cores); a stopped rendering is resumed. The page shows the scenes of an earlier run with --full first, from
# pictures/full.
set -eu
if [ $# -lt 2 ] || [ $# -gt 3 ] || { [ $# -eq 3 ] && [ "$3" != --full ]; }; then
  echo "usage: sh examples/gallery.sh PROGRAMS OUT [--full]" >&2
  exit 2
fi
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
programs=$(CDPATH='' cd -- "$1" && pwd)
out=$2 full=${3-}
quick() { scale=1 more_samples=1 resume=; }
large() { scale=2 more_samples=4 resume=' --resume'; }
quick
if [ "$full" ]; then out=$2/full && large; fi
mkdir -p "$out/input"
cp "$here"/scenes/*.json "$here/layers/table.sh" "$here"/pictures/view_*.jpg "$here"/../lib/docs/view/*.json "$out/input"
# shellcheck source=SCRIPTDIR/gallery_page.sh
. "$here/gallery_page.sh"

# size WIDTH HEIGHT and spp N: options of a rendering, larger with --full.
size() { echo "--size $(($1 * scale))x$(($2 * scale))"; }
spp() { echo "--spp $(($1 * more_samples))$resume"; }

wu_lenses="double_gauss_100mm_f1.35 double_gauss_100mm_f1.7_substitute double_gauss_100mm_f2_28deg"

# The scenes of --full as they were shipped, then as this run renders them.
scenes() {
  title="Scenes through lenses" words="Path tracing and bidirectional path tracing through every surface of a lens."
  if [ -z "$full" ]; then
    large
    shipped=$here/pictures/full
    section scenes_full "$title" "$words Rendered once with <code>sh examples/run.sh --full</code>; the next section has
the same pictures as this machine renders them in minutes, with more noise." halves
    each_scene
    quick
    shipped=
    title="Quick renderings" words="The scenes above at a quarter of the size with a quarter of the samples."
  fi
  section scenes "$title" "$words" halves
  each_scene
}

each_scene() {
  statues="petzval render double_gauss_52mm_f1.8 --scene statues --from entrance_pupil --integrator path $(size 600 400) $(spp 128)"
  table="petzval render double_gauss_100mm_f2_28deg --scene table --focus 920 $(size 600 400) $(spp 96)"
  picture statues/near/picture.png "Two angels at dusk" "A Canon 51.6 mm f/1.8, focused on the angel at 1.5 m. The lamps in the
background are discs, and cat's eyes towards the corners." <<END
$statues --focus 1.5m --out statues/near
END
  picture statues/far/picture.png "The far angel" "Focused at 6 m." <<END
$statues --focus 6m --out statues/far
END
  picture statues/both/picture.png "Both angels in focus" "Impossible for a real lens, in the manner of figure 1 (d) of Lee et al. 2010: a
focal surface through both angels, 1.5 m and 6 m away, and blur at all other distances. The points are in
<a href=\"input/statues_focus.json\">statues_focus.json</a>." <<END
$statues --focus 1.5m --model thin_two_disc --points input/statues_focus.json --out statues/both
END
  picture street/picture.png "A street at night" "Focused on the sign at 3 m, at f/2. Bidirectional path tracing connects small lamps with the
lens, so that their discs are smooth. The dots on the road are reflections in wet stones." <<END
petzval render double_gauss_100mm_f2_28deg --scene street --focus 3m --from entrance_pupil $(size 720 480) $(spp 96) --out street
END
  for lens in $wu_lenses; do
    case $lens in
      *1.35) words="Chess, f/1.35" more="After figure 9 of Wu et al. 2010: focused behind the centre of the board. The lamps in the background are
discs in the centre and cat's eyes in the corners." ;;
      *1.7*) words="Chess, f/1.7" more="The same through a slower lens: smaller discs with a brighter rim." ;;
      *) words="Chess, f/2" more="The discs of the f/2 lens are nearly uniform." ;;
    esac
    picture "chess/$lens/picture.png" "$words" "$more" <<END
petzval render $lens --scene chess --focus 880 $(size 600 400) $(spp 96) --out chess/$lens
END
  done
  picture chess/pinhole/picture.png "Chess through a pinhole" "The same scene: everything is sharp." <<END
petzval render double_gauss_100mm_f2_28deg --scene chess --focus 880 --model pinhole $(size 600 400) $(spp 16) --out chess/pinhole
END
  picture table/upright/picture.png "A table in front of lamps" "Round discs above the table, cat's eyes in all four corners." <<END
$table --out table/upright
END
  picture table/tilted/picture.png "The table on a tilted film" "The film is tilted by 12 degrees, so that the plane of focus lies closer to the table top." <<END
$table --tilt 12 --model thick --out table/tilted
END
  picture table/curved/picture.png "Curvature of field" "The tilted film is also curved, in the manner of figure 6 of Lee et al. 2010: the table is sharp only
in the centre." <<END
$table --tilt 12 --model thick --curvature-points 0,0:0 18,0:3 -18,0:3 0,12:1.5 0,-12:1.5 --out table/curved
END
}

blurred() {
  section blur "Lens blur from layers" "A renderer's picture from the centre of the lens, with up to four surfaces behind each other in a
pixel, is blurred by hundreds of rays per pixel: after Lee, Eisemann, Seidel 2010, for any lens." halves
  picture layers/town/blur.png "A market town" "A thin lens of 50 mm, 100 mm wide, focused on the stall at 5 m. The lamp post and the railing at
2.3 m are transparent veils, because the layers hold the street behind them." <<END
petzval blur --scene town --thin-lens 50 --f-number 0.5 --focus 5m --supersample 4 --out layers/town
END
  also layers/town/sharp.png "The town through a pinhole" "The contents of the first layer."
  picture layers/miniature/blur.png "A miniature" "The town from above on a film that is tilted by 8 degrees: only a strip across the town is in focus,
as in a photograph of a model. Compare the windows in the middle with the roofs at both ends; in the manner of figure 1 (b) of the paper." <<END
petzval blur --scene miniature --thin-lens 50 --f-number 0.8 --focus 12m --tilt 8 --rays 512 --out layers/miniature
END
  picture layers/cats_eyes/blur.png "Cat's eyes" "Lights in all directions behind an angel at 3 m, through a double Gauss 100 mm f/1.35 by exact rays. Each disc is
the part of the pupil that the rims of the lens leave open: a cat's eye whose tips lie on a circle around the centre." <<END
petzval blur double_gauss_100mm_f1.35 --scene lights --focus 3m --from entrance_pupil --fov 22 --rays 512 --size 640x480 \\
  --out layers/cats_eyes
END
  picture layers/night/blur.png "Six blades" "A street at night: the discs of bright and dim lamps are uniform images of the iris." <<END
petzval blur --scene street --thin-lens 100 --f-number 2 --focus 3m --fov 14 --blades 6 --out layers/night
END
  picture layers/singlet/blur.png "A single element" "A biconvex lens of N-BK7 at one wavelength: spherical aberration gives the discs a bright core and the
angel a halo; coma draws the cores outwards, towards the corners." <<END
petzval blur --scene lights --singlet 103.36,-103.36,16,N-BK7 --f-number 2.8 --focus 2850mm --fov 22 --size 640x480 \\
  --out layers/singlet
END
  picture layers/colour/blur.png "A single element, with dispersion" "The same with separate rays for red, green and blue, at 650, 510 and 475 nm: white lights get
coloured rims, because each colour has its own focal length." <<END
petzval blur --scene lights --singlet 103.36,-103.36,16,N-BK7 --f-number 2.8 --focus 2850mm --fov 22 --size 640x480 \\
  --wavelengths rgb --out layers/colour
END
  picture layers/surface/blur.png "A focal surface" "Both angels are sharp, 1.5 m and 6 m away, and the urn between them is not: no camera with a plane of
focus can do this." <<END
petzval blur --scene statues --thin-lens 50 --f-number 1.79 --focus 5m --points input/statues_focus.json --supersample 4 \\
  --out layers/surface
END
  picture layers/knot/blur.png "A knot" "864,000 triangles: turns of the tube are blurred in front of and behind sharp turns." <<END
petzval blur --scene knot --thin-lens 50 --f-number 0.5 --focus 3600mm --out layers/knot
END
  picture layers/leaves/blur.png "Leaves" "The hardest case for layers: on average twelve surfaces behind each other in a pixel; eight layers." <<END
petzval blur --scene leaves --thin-lens 50 --f-number 0.5 --focus 5m --layers 8 --out layers/leaves
END
}

window() {
  section view "Focus by clicking" "<code>petzval view</code>: the blur from layers in a window. A click focuses the lens on the surface under the
mouse."
  picture view/click.jpg "One click" "The stall is sharp. On the right are all controls, below the section of the lens with the rays of the point under
the mouse, and its bokeh. The picture of the window is shipped; the line with # makes it on a screen." <<END
# petzval view --replay input/click.json --screenshot view/click.png
cp input/view_click.jpg view/click.jpg
END
  picture view/tilt.jpg "Three clicks" "A tilted film meets three points: on the awning, at a window and on the street. The map shows sharp surfaces in
green, nearer ones in red and farther ones in blue." <<END
# petzval view --replay input/tilt.json --panels map --screenshot view/tilt.png
cp input/view_tilt.jpg view/tilt.jpg
END
  picture view/pull.html "A focus pull by four clicks" "From the lamp post over the tree and the stall to the tower, without the window: <code>--replay</code> computes the
picture after each click. The state after each click, in words: <a href=\"view/pull.txt\">pull.txt</a>." <<END
echo '{"scene": "town", "lens": {"thin_mm": 50, "f_number": 0.5}, "size": [400, 300], "events": [
  {"type": "add_point", "id": "lens", "pixel": [100, 200]}, {"type": "move_point", "id": "lens", "pixel": [130, 280]},
  {"type": "move_point", "id": "lens", "pixel": [171, 131]}, {"type": "move_point", "id": "lens", "pixel": [200, 60]}]}' > view/pull.json
petzval view --replay view/pull.json --rays 256 --out view/pull > view/pull.txt
for n in 1 2 3 4; do
  echo "<img src=view/pull/event_000\$n.png alt='click \$n' style='display:inline; width:24%'>"
done > view/pull.html
END
}

measured() {
  section measured "Lens blur, measured" "Quality, time and flicker of the blur from layers, after figure 7 and table 1 of Lee et al. 2010."
  picture layers/rays/ray_counts.svg "Quality against the number of rays" "A pupil of 300 mm: 32, 100 and 750 rays per pixel against 100,000 rays through the same
layers. From 100 rays on the difference is hard to see." <<END
petzval blur --scene town --thin-lens 50 --f-number 0.1667 --focus 5m --rays 32,100,750 --compare-rays 100000 --supersample 1 \\
  --size 294x220 --out layers/rays
END
  also layers/rays/rays.svg "PSNR against the number of rays" "Against 100,000 rays of the same layers."
  picture layers/frames/frames.svg "A focus pull" "From the lamp post at 2.3 m over the stall at 5 m to the tower. The flicker, the RMS change of the error from frame to
frame, is in <a href=\"layers/frames/blur.json\">blur.json</a> (white is 1)." <<END
echo '[{"keys": [{"time_s": 0, "position_mm": [0, 0, -2300]}, {"time_s": 2, "position_mm": [0, 0, -5000]},
  {"time_s": 4, "position_mm": [0, 0, -12000]}]}]' > layers/keys.json
petzval blur --scene town --thin-lens 50 --f-number 0.3 --focus 5m --points layers/keys.json --frames 8 --fps 2 --compare \\
  --size 294x220 --rays 128 --supersample 1 --out layers/frames
END
  picture layers/table.md "Table 1 for five scenes" "The paper's size and 100 rays per pixel. Peel: finding the layers; reference: the same rays traced through the scene,
with which PSNR, SSIM and energy compare. The paper has 34.8 to 36.9 dB for its scenes; here a pupil of 18 mm has 39 dB and more. Decibels are lost at
edges near the plane of focus, where a pixel of the layers has one depth (one sample per pixel costs 5 to 8 dB), and in street at 100 mm, where
25 rays of a subpixel show a lamp as dots that lie in other pixels than in the reference." <<END
sh input/table.sh petzval layers/table > layers/table.md
END
}

# tilted FOLDER POINTS OPTION...: a fit of the film to points.
tilted() {
  folder=tilt/$1 points=input/$2.json
  shift 2
  echo "petzval tilt double_gauss_100mm_f2_28deg --f-number 4 --points $points${*:+ $*} --out $folder > $folder.txt"
}

focus() {
  section focus "Control of the focus" "Given points that should be sharp, <code>petzval tilt</code> finds the film with the smallest sum of
squared blurs, by exact rays. The lens is the double Gauss 100 mm at f/4. Colour is the signed diameter of the blur: blue nearer than the plane of focus,
red beyond it, at most 30 µm between the thin lines." halves
  stem=double_gauss_100mm_f2_28deg
  picture tilt/table/${stem}_before.svg "A table top, film upright" "Only the narrow strip between the thin lines is sharp. Points 1 and 2 at the front
edge and 4 and 5 at the back are blurred by about half a millimetre, with opposite signs: no upright film makes both edges sharp." <<END
$(tilted table table)
END
  also tilt/table/${stem}_after.svg "Film tilted by 15 degrees" "The same scale: the colour has nearly vanished. The remaining rings, with opposite signs
inside and outside, are curvature of field, which no flat film can follow; the fit divides it between centre and edge.
<a href=\"tilt/table.txt\">Numbers</a>."
  also tilt/table/${stem}_side.svg "From the side" "Above: the plane of focus (green) meets the front principal plane, and the plane of the film (thin
black) the rear one, at the same height, the Scheimpflug line (short violet stroke). The depth of field (pale green) begins at the hinge line, in the
front focal plane. Below: the dots are the images of the five points; they lie on the tilted film, not on the upright film (dashed)."
  picture tilt/facade/${stem}_side.svg "A receding facade, from above" "The film swings, so the section lies in x. The depth of field is a wedge that widens
with distance, from the hinge line at one side of the camera." <<END
$(tilted facade facade)
END
  picture tilt/outlier/${stem}_after.svg "A wrong point among eight" "Point 6 lies far in front of the wall. Least squares tilt the film towards it and blur 2
and 5. The map interpolates the scene between the points, so it bulges at 6." <<END
$(tilted outlier facade_outlier)
END
  picture tilt/robust/${stem}_after.svg "The wrong point ignored" "With <code>--robust</code> point 6 gets no weight; it is grey in the picture and an outlier
in <a href=\"tilt/robust.txt\">the table</a>. All other points are within 35 µm. The scale is half of the scale before." <<END
$(tilted robust facade_outlier --robust)
END
  picture pull/${stem}_focus_pull.svg "A focus pull" "From 0.8 m to 2.5 m, a rest, and on to infinity, at f/2. At the keys (dotted) the curves are level and
never overshoot. The bottom diagram shows the blur that focusing cannot remove: the aberrations of the lens, which are largest at close distances.
<a href=\"pull/${stem}_focus_pull.csv\">A row for every frame</a>." <<END
petzval pull double_gauss_100mm_f2_28deg --f-number 2 --keys input/rack.json --out pull
END
  picture surface/surface.svg "A focal surface" "The distances in focus for the angels above: points 1 to 5 at 1.5 m, 6 to 10 at 6 m, and the distances and
blurs of points 11 to 16. (Here positions count from the first vertex, in the scene from the entrance pupil 25 mm behind it.) The same surface
<a href=\"surface/side.svg\">in section</a> and as <a href=\"surface/surface.pfm\">1/distance</a>." <<END
petzval surface double_gauss_52mm_f1.8 --points input/statues_focus.json --size 600x400 --focus 1500 --out surface
END
}

wu_designs() {
  section wu_lenses "Wu et al. 2010: the lenses" "After figure 6 of the paper: the profiles of its three lenses and their pupils." halves
  for lens in $wu_lenses; do
    case $lens in
      *1.35) words="f/1.35" more="Lowenthal's double Gauss." ;;
      *1.7*) words="f/1.7" more="A substitute: the lens of the paper was not found." ;;
      *) words="f/2" more="Double Gauss with a field of 28 degrees." ;;
    esac
    picture "lenses/${lens}_layout.svg" "Profile, $words" "$more <a href=\"lenses/$lens.html\">Table of surfaces, with spots and focus</a>." <<END
petzval report $lens --out lenses
END
    also "lenses/${lens}_footprints.svg" "Pupils, $words" "The entrance pupil of each field, clipped by the rims of the lens: the shape of a blurred light there."
  done
}

wu() {
  section wu "Wu et al. 2010" "The figures of the paper on bokeh, computed from the lenses themselves. A bright rim or a bright core of a disc is spherical
aberration, in front of or behind the focus."
  picture wu/dots/picture.png "Figure 5: a grid of dots" "White dots of 3 mm, 1 m in front of a Planar 50 mm f/1.4 wide open: spherical aberration in the middle,
coma half way. The paper draws the corner dots out along the radius; the Planar draws them out along the tangent: rims clip its pupil to a lens shape
across the radius, and its sagittal focus lies behind the film, the tangential one near it. At 20 degrees the RMS is 19 &micro;m along the radius and 60 &micro;m along the
tangent, equal when the lens is focused at 0.82 m." <<END
petzval render planar_50mm_f1.4 --scene input/dots.json --focus 1m --from entrance_pupil --integrator light $(size 1200 800) $(spp 8) \
  --out wu/dots
END
  picture wu/dots_petzval/picture.png "The same dots along the radius" "Through a Petzval portrait lens of 1840: its curved tangential focus draws the outer dots out along the
radius, as in the paper. At 10 degrees the RMS is 106 &micro;m along the radius and 6 &micro;m along the tangent." <<END
petzval render petzval_portrait_100mm_f3.4 --scene input/dots.json --focus 1m --from entrance_pupil --integrator light \
  --film 60x40 --exposure 0.35 $(size 1200 800) $(spp 8) --out wu/dots_petzval
END
  picture wu/dots/crops.html "The dots enlarged" "Centre, half way and corner: above through the Planar, below through the Petzval lens." <<'END'
{
  echo '<svg viewBox="0 0 306 204" style="background:#fff">'
  row=0
  for view in 'dots 550,350 788,236 1026,4' 'dots_petzval 550,350 846,200 996,50'; do
    set -- $view
    column=0 file=$1 && shift
    for at; do
      echo "<svg x=\"$((102 * column))\" y=\"$((102 * row))\" width=\"100\" height=\"100\" viewBox=\"${at%,*} ${at#*,} 100 100\">"
      echo "<image href=\"wu/$file/picture.png\" width=\"1200\" height=\"800\" style=\"image-rendering:pixelated\"/></svg>"
      column=$((column + 1))
    done
    row=$((row + 1))
  done
  echo '</svg>'
} > wu/dots/crops.html
END
  picture wu/figure7.svg "Figure 7: bokeh of three lenses" "A point light is at 1000 mm; each column has a different focus distance. Focused nearer than the light
(left), the first two lenses draw a thin bright rim; focused farther (right), a bright core with a slightly darker centre. The third lens does the
opposite; at 800 mm its disc is nearly uniform with a bright core, while the paper calls it uniform. The Tronnier f/2 below it, an equally likely source
of the paper's third row, behaves like the first two lenses. Film at the smallest RMS blur: 1000 mm is the sharpest column for every lens." <<END
wu_figure7 --criterion min_rms --out wu/figure7.svg
END
  picture wu/figure7_paraxial.svg "Figure 7 with the film at the paraxial focus" "Marginal rays shift every profile, most in the third row, which is now
sharpest when focused at 1100 mm." <<END
wu_figure7 --criterion paraxial --out wu/figure7_paraxial.svg
END
  picture wu/statements.html "The statements of the paper, measured" "The radial profile of each picture in the words of the paper. The text defines neither
\"in focus\" nor the origin of \"from the lens\", so the table shows all four interpretations; the measurements are in
<a href=\"wu/statements.txt\">statements.txt</a>. The Tronnier is compared with the statements about the third row." <<END
wu_statements --html wu/statements.html > wu/statements.txt
END
  for lens in $wu_lenses; do
    case $lens in
      *1.35) words="Figure 8: lights over the field, f/1.35" more="In the manner of figure 8: thirteen balls 1059 mm in front of the lens, each with a
small light. The discs are circles in the centre and cat's eyes towards the edge, with a bright side: coma. Below, three of them enlarged, at the five
focus distances: the rims and cores of figure 7, clipped by the rims of the lens. Each strip has its own exposure. Axis ratio, orientation and skewness of
all highlights are in" ;;
      *1.7*) words="Figure 8: f/1.7" more="The same. The numbers:" ;;
      *) words="Figure 8: f/2" more="The same; this lens vignettes least. The numbers:" ;;
    esac
    picture "balls/$lens.svg" "$words" "$more <a href=\"balls/$lens.csv\">$lens.csv</a>." <<END
$(for focus in 800 900 1000 1100 1200; do
  echo "petzval render $lens --scene input/row_of_lights.json --focus $focus --film 36x3 $(size 1208 100) $(spp 32) --out balls/${lens}_$focus"
done)
petzval sheet --title "A row of lights" --out balls/$lens.svg --balls balls/$lens.csv \\
 $(for focus in 800 900 1000 1100 1200; do printf ' balls/%s' "${lens}_$focus"; done)
END
  done
}

bokeh() {
  section bokeh "Bokeh" "Images of a point of light."
  picture bokeh/double_gauss_100mm_f1.35_bokeh.svg "Off axis, in colour" "The f/1.35 lens with the light 8 degrees off axis, in 25 wavelengths. The rims of the
outer elements clip the disc, coma draws it to a point, and its edge is blue when focused nearer than the light, red when farther." <<END
petzval psf double_gauss_100mm_f1.35 --at 1000 --focus 800,900,1000,1100,1200 --criterion paraxial --fields 8 \\
  --wavelengths $(seq -s , 430 10 670) --rays 262144 --out bokeh
END
  picture colour/double_gauss_100mm_f1.35_chromatic.svg "The colours of bokeh" "Blue light has the shorter focus in this lens of 1951. Each disc has a blue and
green outline when focused nearer than the light, a red outline when farther, with the other colours in the centre. Three wavelengths give hard edges, 26
wavelengths blend. The shifts of focus and of the chief ray are in <a href=\"colour/shifts.txt\">shifts.txt</a>." <<END
petzval colour double_gauss_100mm_f1.35 --rays 524288 --out colour > colour/shifts.txt
END
  picture shapes/bokeh_blades.svg "Irises with blades" "A far point light through 3 to 9 blades. As in a photograph, the first corner points straight up. The
corners are on the edge of the disc of a round iris. Spherical aberration bends the edges slightly inwards although the blades are straight." <<END
petzval shapes --out shapes
END
  also shapes/bokeh_cats_eyes.svg "Cat's eyes" "The f/1.35 lens over its field, and two discs fitted to its pupils seen from the film: at 11.5 degrees they
transmit 68 % of the light, the lens 66 %. A far point light shows the pupil seen from the scene, where the two discs are 14 % larger on the axis and 1.4
times as large at 11.5 degrees. The bright rim and the bent lower edge are aberrations, which a thin lens does not have."
  also shapes/bokeh_lens_ratio.svg "Lens ratio from 0.2 to 2" "A thin lens with a second rim. Below 1 the second rim makes the disc smaller; near 1 it clips
the disc off the axis to a cat's eye; at 2 it clips nothing at 10 degrees. On the axis a far light sees the second rim slightly smaller than the film
does."
  also shapes/bokeh_weights.svg "Weights of the stop" "Rays weighted by their position on the stop, traced through every surface of the lens. The weights conserve
the light on the iris; in the picture the tiles of a row differ by about 1 % at f/4. Lines of equal brightness follow the blades."
  also shapes/bokeh_maps.svg "Maps of the stop" "Images over the stop: the rings of a lathe-turned aspheric mould, and a cut-out iris. A far light shows the heart
upright, as it was cut."
  picture expressive/highlights.svg "An expressive lens" "The f/1.35 lens, focused at 1 m; its first-order model with a power spline and a curved film, both
fitted to the lens; and the model without them. On the axis the spline reproduces the bright core and the bright rim. It cannot have coma. The numbers,
for editing: <a href=\"expressive/expressive.json\">expressive.json</a>." <<END
petzval expressive double_gauss_100mm_f1.35 --focus 1000 --rays 65536 --out expressive
END
  picture psf_set/psf_set.svg "A set of PSFs" "Double Gauss 100 mm f/2, focused at 2000 mm: the field grows to the right, the distance downwards, and up is away
from the centre of the photograph. Cat's eyes narrow with the field, and their light decreases. Lights nearer than the focus have a ring inside the edge,
lights beyond it a bright rim and core. The row in focus, which has a separate scale, shows coma and caustics. The data:
<a href=\"psf_set/psf_set.exr\">psf_set.exr</a>, <a href=\"psf_set/psf_set.json\">psf_set.json</a>." <<END
petzval psf-set double_gauss_100mm_f2_28deg --fields 0,5,10,14 --at 1000,1400,2000,4000,inf --focus 2000 --out psf_set
END
}

# spots LENS TITLE FIELDS WAVELENGTHS CAPTION
spots() {
  picture "spots/$1_spots.svg" "$2" "$5 <a href=\"spots/$1_spots.json\">Numbers</a>, <a href=\"spots/$1_spots.csv\">hits</a>." <<END
petzval spots $1 --fields $3 --wavelengths $4 --out spots
END
}

# lens LENS TITLE CAPTION
lens() {
  picture "lenses/$1_layout.svg" "$2" "$3 <a href=\"lenses/$1.html\">Report</a>." <<END
petzval report $1 --out lenses
END
}

designs() {
  section spots "Spot diagrams" "Film points of the rays from a distant point. The film is focused on the axis at the d line (smallest RMS radius)." halves
  spots double_gauss_100mm_f1.35 "Double Gauss 100 mm f/1.35" 0,7,12 F,d,C "Small on axis; coma and a wide halo in the field are the price of speed."
  spots double_gauss_100mm_f2_28deg "Double Gauss 100 mm f/2, 28 degree field" 0,10,14 F,d,C "Nearly the same size from the centre to the corner."
  spots cooke_triplet_50mm_f5 "Cooke triplet 50 mm f/5" 0,14,20 F,d,C "Three elements cover 20 degrees. Astigmatism draws the spot at 14 degrees to a line;
blue spreads most."
  spots petzval_portrait_100mm_f3.4 "Petzval portrait lens 100 mm f/3.4 of 1840" 0,7,12 F,d,C "Sharp on axis; towards the edge the curvature of field draws
each spot out along the radius."
  spots fisheye_10mm_f4 "Fisheye 10 mm f/4" 0,40,70 587.5618 "A sharp image even 70 degrees off axis, where the pupil is far from its paraxial position. The
source prints no Abbe numbers, so only the d line is shown."

  section lenses "Twelve lenses" "Sections along the axis, to scale, with transmitted rays: one colour per field, at 0, 0.7 and 1 of the edge. The reports have
spots, pupils, focus curve, brightness and the prescription." halves
  lens petzval_portrait_100mm_f3.4 "Petzval portrait lens, 1840" "The first computed lens: two achromats far apart, fast for its time. Its field is curved: see
the focus curve."
  lens cooke_triplet_50mm_f5 "Cooke triplet" "Three elements are the minimum for the correction of all five Seidel aberrations; the negative element is at the stop."
  lens planar_1896_f4.5 "Planar of 1896" "The symmetrical double Gauss: the halves cancel each other's coma and distortion."
  lens tessar_100mm_f5.5_1902 "Tessar, 1902" "The triplet with a cemented rear doublet; small, slow, and sharp over 60 degrees."
  lens sonnar_180mm_f2.8 "Sonnar 180 mm f/2.8" "The Olympia Sonnar: thick front elements have the power; a thin lens is far behind them."
  lens biogon_35mm_f2.8 "Biogon 35 mm f/2.8" "Wide and close to the film: the rear element almost touches it."
  lens telephoto_250mm_f5.6 "Telephoto 250 mm f/5.6" "Shorter than its focal length: the negative rear group moves the principal plane in front of the lens."
  lens retrofocus_100mm_f2 "Retrofocus 100 mm f/2" "A reversed telephoto: the negative front makes space for a mirror and makes the field brighter than cos⁴, up
to the edge, where rims vignette."
  lens catadioptric_mangin_1000mm_f7.5 "Mirror lens 1000 mm f/7.5" "Two Mangin mirrors fold a metre into a quarter of the length. The annular pupil gives annular
bokeh."
  lens anamorphic_60mm_2x "Anamorphic 60 x 31 mm" "Cylinders in front nearly double the horizontal field. The report shows both sections."
  lens modern_58mm_f0.95 "Fast normal lens, 2019" "Seventeen elements and three aspheres for f/0.98; at the edge of the field most of the pupil is vignetted."
  lens fisheye_6.3mm_f2.8 "Fisheye 6.3 mm f/2.8, 220 degrees" "Rays of the red field come from behind the front element. Their entrance pupil is 41 mm from its
paraxial position."

  section models "Models of a lens" "A renderer can trace every surface or use a faster, less accurate model of the lens."
  picture models/double_gauss_100mm_f2_28deg_accuracy_speed.svg "Accuracy and speed" "Double Gauss 100 mm f/2 on 24 x 36 mm: two more degrees of a polynomial
cost little and reduce the error by a factor of seven. The table and the model for each of four budgets are in
<a href=\"models/accuracy_speed.txt\">accuracy_speed.txt</a>, the choice for a scene with its reasons in <a href=\"models/choose.txt\">choose.txt</a>." <<END
petzval models double_gauss_100mm_f2_28deg --f-number 2 --out models > models/accuracy_speed.txt
petzval choose double_gauss_100mm_f2_28deg --f-number 2 --near 2000 --far inf --budget 0.5 > models/choose.txt
END
}

ghosts() {
  section ghosts "Ghosts" "Light of the sun, 9 degrees to the right and 6 above the axis, that two surfaces of a double Gauss reflect to the film. Six
blades at f/5.6 give the ghosts their corners. The numbers are irradiances, which add to a picture in the same unit." halves
  sun="petzval ghosts double_gauss_100mm_f2_28deg --light 9,6 --f-number 5.6 --blades 6 --wavelengths visible --size 600x400"
  picture ghosts/none/ghosts.png "Without coatings" "Ghosts hold 0.24 % of the light that enters the first surface within its rim; the
image of the sun holds 4.8 %. The table is <a href=\"ghosts/none/ghosts.txt\">ghosts.txt</a>." <<END
$sun --out ghosts/none
END
  also ghosts/none/double_gauss_100mm_f2_28deg_ghosts.svg "The paths" "Rays of the five brightest pairs of surfaces."
  picture ghosts/mgf2/ghosts.png "One layer of magnesium fluoride" "A quarter wave at 550 nm on each surface to air reflects violet and red. Ghosts hold
0.008 % of the light: the picture is 30 times as bright as it would be beside the first." <<END
$sun --coatings mgf2 --out ghosts/mgf2
END
  picture ghosts/starburst/ghosts.png "Starburst" "The sun nearer to the axis, at f/11: the six edges of the iris diffract six spikes. The starburst has
16 % of the light of the sun's image, most of it within one pixel and 0.12 % farther than 1 mm away. The ghosts in the picture have 0.07 %." <<END
petzval ghosts double_gauss_100mm_f2_28deg --light 6,3.5 --f-number 11 --blades 6 --coatings mgf2 --wavelengths visible --starburst --size 600x400 \\
  --out ghosts/starburst
END
  street="petzval render double_gauss_52mm_f1.8 --scene input/night_street.json --focus 13m --f-number 5.6 --blades 6 --from entrance_pupil --size 600x400 --spp 64"
  picture ghosts/street/picture.png "A street without ghosts" "The lamps are up to 900 times as bright as white." <<END
$street --out ghosts/street
END
  picture ghosts/lamps/picture.png "The street with ghosts" "The same picture with the ghosts of 32 points of lamps and windows. They add 3.5 % to its light;
with magnesium fluoride on each surface to air, 0.04 %." <<END
cp -r ghosts/street/. ghosts/lamps
$street --ghosts 32 --resume --out ghosts/lamps
END
}

pictures() {
  scenes
  blurred
  window
  measured
  focus
  wu_designs
  wu
  bokeh
  ghosts
  designs
}

gallery "$out" "$programs" pictures "petzval: gallery" "Made by the program <code>petzval</code>: exact rays through published lens
prescriptions, without diffraction. Each picture has its command, for a shell in the folder of this page with <code>petzval</code> in
<code>PATH</code>, and the time that it took."
