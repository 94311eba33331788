# SPDX-License-Identifier: Apache-2.0
"""PSFs of a lens for image restoration: psf.npy [field, colour, height, width], illumination.npy [field] and
distortion.npy [field], the arrays of NTIRE 2026's challenge on blind aberration correction; and fields_deg.npy.

    python3 psf_stack.py [LENS] [FOLDER] [FIELDS] [F_NUMBER]

Each PSF is centred on its centroid at the middle wavelength and has the sum 1 for each colour (red, green, blue).
Illumination is relative to the axis. Distortion is relative to f tan(field): 0.01 is 1 %. PSFs are geometric: they hold
where the blur is larger than the Airy disc.
"""
import math
import os
import sys

import numpy
import petzval

name = sys.argv[1] if len(sys.argv) > 1 else "double_gauss_52mm_f1.8"
folder = sys.argv[2] if len(sys.argv) > 2 else "psf_stack"
count = int(sys.argv[3]) if len(sys.argv) > 3 else 64
colours, pixels, pixel_mm = (610, 540, 460), 64, 0.004
lens = petzval.Lens(name, wavelengths_nm=colours, primary_nm=540, clamp=True)
if len(sys.argv) > 4:
    lens.f_number(float(sys.argv[4]))
lens.focus(math.inf)
info = lens.info
declared = info.declared_half_field_deg
half_field = declared if math.isfinite(declared) else math.degrees(math.atan(21.6 / abs(info.focal_length_mm)))
radius = 1.3 * abs(info.focal_length_mm) * math.tan(math.radians(half_field))
camera = petzval.Camera(lens, petzval.Film(width_mm=2 * radius, height_mm=2 * radius, columns=2000, rows=2000))
fields = numpy.linspace(0, half_field, count)
stack = numpy.zeros((count, len(colours), pixels, pixels), numpy.float32)
light = numpy.zeros(count)
height = numpy.zeros(count)
pupil_u, pupil_v = (numpy.arange(4096) + 0.5) / 4096, (numpy.arange(4096) * 0.6180339887498949) % 1
for index, field in enumerate(numpy.radians(fields)):
    direction = (0, math.sin(field), -math.cos(field))
    psf, _ = camera.point_image(direction, pixels=2, samples=1 << 12, distant=True)
    psf, image = camera.point_image(direction, pixels=pixels, samples=1 << 16, half_width_mm=pixels * pixel_mm / 2,
                                    centre_mm=tuple(psf.centroid_mm), distant=True)
    sums = image.sum(axis=(1, 2), keepdims=True)
    stack[index] = numpy.where(sums > 0, image / numpy.maximum(sums, 1e-30), 0)
    height[index] = -psf.centroid_mm[1]
    # Irradiance of the film there: the mean weight of rays, which are lost beyond the edge of the light.
    column, row = 1000, 1000 - 1000 * height[index] / radius
    rays = camera.sample(numpy.full(4096, column), numpy.full(4096, row), pupil_u, pupil_v)
    light[index] = rays["weights"].mean()
tangent = info.focal_length_mm * numpy.tan(numpy.radians(fields))
distortion = numpy.divide(height - tangent, tangent, out=numpy.zeros(count), where=tangent != 0)
illumination = light / light[0]
os.makedirs(folder, exist_ok=True)
for file, values in (("psf", stack), ("illumination", illumination), ("distortion", distortion), ("fields_deg", fields)):
    numpy.save(os.path.join(folder, file + ".npy"), values.astype(numpy.float32))
print(f"{lens.name}: {count} fields to {half_field:.1f} degrees; illumination at the edge {illumination[-1]:.3f}, "
      f"distortion {100 * distortion[-1]:.2f} %; wrote {folder}/")
