# SPDX-License-Identifier: Apache-2.0
"""Spots of a lens over its field: RMS radii, and a figure if matplotlib is installed.

    python3 spots.py [LENS] [OUT.png]
"""
import math
import sys

import petzval

name = sys.argv[1] if len(sys.argv) > 1 else "double_gauss_52mm_f1.8"
lens = petzval.Lens(name, wavelengths_nm=[486.1327, 587.5618, 656.2725]).focus(5000)
camera = petzval.Camera(lens, petzval.Film(width_mm=60, height_mm=60), model="exact_double")
half_field = lens.info.declared_half_field_deg
half_field = half_field if math.isfinite(half_field) else 15
pupil_z = lens.info.entrance_pupil_z_mm
print(f"{lens.name}, f/{lens.info.f_number:.2f}, focused at 5 m")
spots = []
for field in (0, 0.5 * half_field, 0.9 * half_field):
    point = (0, math.tan(math.radians(field)) * (5000 + pupil_z), -5000)
    for nm in (486.1327, 587.5618, 656.2725):
        x, y, _ = camera.spot(point, 2000, nm)
        if len(x) == 0:
            continue
        mx, my = sum(x) / len(x), sum(y) / len(y)
        rms = math.sqrt(sum((a - mx) ** 2 + (b - my) ** 2 for a, b in zip(x, y)) / len(x))
        print(f"  {field:5.1f} degrees  {nm:5.0f} nm  RMS radius {1000 * rms:7.2f} um  at y = {my:8.4f} mm")
        spots.append((field, nm, x, y))
try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
except ImportError:
    sys.exit()
fields = sorted({field for field, *_ in spots})
figure, axes = pyplot.subplots(1, len(fields), figsize=(4 * len(fields), 4), squeeze=False)
for field, nm, x, y in spots:
    axis = axes[0][fields.index(field)]
    middle = [one for one in spots if one[0] == field][0]
    axis.plot([1000 * (a - sum(middle[2]) / len(middle[2])) for a in x], [1000 * (b - sum(middle[3]) / len(middle[3])) for b in y],
              ".", markersize=1, color={486.1327: "tab:blue", 587.5618: "tab:green"}.get(nm, "tab:red"), label=f"{nm:.0f} nm")
    axis.set(title=f"{field:.1f} degrees", xlabel="x, um", ylabel="y, um", aspect="equal")
axes[0][0].legend()
out = sys.argv[2] if len(sys.argv) > 2 else "spots.png"
figure.tight_layout()
figure.savefig(out)
print("wrote", out)
