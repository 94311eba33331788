# SPDX-License-Identifier: Apache-2.0
"""Focuses a lens on points of a scene: with an upright film, and with a tilted one. Needs no NumPy.

    python3 autofocus.py [LENS]
"""
import math
import sys

import petzval

lens = petzval.Lens(sys.argv[1] if len(sys.argv) > 1 else "double_gauss_52mm_f1.8").f_number(4).focus(2000)
points = [(-300, -200, -1500), (400, -150, -2500), (0, 500, -4000)]
for max_tilt in (0, 0.35):
    film, fit = lens.fit_film(points, petzval.Film(width_mm=36, height_mm=24, columns=1920, rows=1280), max_tilt)
    camera = petzval.Camera(lens, film)
    print(f"{'tilted' if max_tilt else 'upright'} film: z = {film.z_mm:.3f} mm, tilt {math.degrees(film.tilt_rad):.2f} degrees, "
          f"swing {math.degrees(film.swing_rad):.2f} degrees, RMS blur {1000 * fit.rms_mm:.1f} um")
    for point in points:
        x, y, _ = camera.spot(point, 1000)
        mx, my = sum(x) / len(x), sum(y) / len(y)
        rms = math.sqrt(sum((a - mx) ** 2 + (b - my) ** 2 for a, b in zip(x, y)) / len(x))
        print(f"  point at {-point[2] / 1000:.1f} m: spot radius {1000 * rms:6.1f} um")
