# SPDX-License-Identifier: Apache-2.0
"""Blurs an EXR with channels R, G, B, A and Z through a lens. Needs NumPy and OpenImageIO.

    python3 blur_exr.py PICTURE.exr BLURRED.exr [LENS] [FOCUS_MM] [F_NUMBER] [MM_PER_UNIT]

Z is the depth along the axis, in units of MM_PER_UNIT (default 1000: metres). The picture must have been rendered with
the angle of view that the lens has on a film 36 mm wide; petzval.LensRays.info() gives it as focal_px.
"""
import os
import sys

import numpy
import OpenImageIO
import petzval

source, blurred = sys.argv[1:3]
lens_name, focus_mm, f_number, mm_per_unit = sys.argv[3:] + ["double_gauss_52mm_f1.8", 2000, 2.8, 1000][len(sys.argv) - 3:]
image = OpenImageIO.ImageBuf(source)
names, pixels = image.spec().channelnames, image.get_pixels(OpenImageIO.FLOAT)
if image.has_error or not {"R", "G", "B", "Z"} <= set(names):
    sys.exit(f"{source}: {image.geterror() or 'channels = ' + ', '.join(names) + '; must include R, G, B and Z'}")
rows, columns, _ = pixels.shape
rgba = numpy.stack([pixels[..., names.index(c)] if c in names else numpy.ones((rows, columns)) for c in "RGBA"], axis=-1)
depth_mm = pixels[..., names.index("Z")] * float(mm_per_unit)

lens = petzval.Lens(lens_name).f_number(float(f_number)).focus(float(focus_mm))
camera = petzval.Camera(lens, petzval.Film(width_mm=36, height_mm=36 * rows / columns, columns=columns, rows=rows),
                        normalisation="unity_on_axis")
rays = petzval.LensRays(camera, over_pixels=True, threads=os.cpu_count())
layers = petzval.Layers(columns, rows, [(rgba, depth_mm)])
picture = petzval.Blur().gather(layers, rays, threads=os.cpu_count())

output = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(columns, rows, 4, OpenImageIO.FLOAT))
output.set_pixels(OpenImageIO.ROI.All, picture)
if not output.write(blurred):
    sys.exit(f"{blurred}: {output.geterror()}")
