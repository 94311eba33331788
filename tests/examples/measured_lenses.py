# SPDX-License-Identifier: Apache-2.0
"""Computed calibrations of five lenses beside Lensfun's measurements of the lenses that were sold under these patents or
names. Reads the database of liblensfun-data-v1 in place and prints a table; the exit status is 1 if a difference is too
large.

    python3 measured_lenses.py PETZVAL_PROGRAM [FOLDER_OF_THE_DATABASE]
"""
import glob
import json
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

program = sys.argv[1]
folder = sys.argv[2] if len(sys.argv) > 2 else "/usr/share/lensfun/version_1"
if not os.path.isdir(folder):
    print(f"{folder} is missing: install liblensfun-data-v1")
    sys.exit(77)  # skipped
# Lens of petzval, Lensfun's name and focal length, positions of the comparison relative to half of the shorter side.
partners = [("zoom_14-30mm_f4", "NIKKOR Z 14-30mm f/4 S", 14, (1, 1.8)),
            ("defocus_control_135mm_f2", "Nikon AF DC-Nikkor 135mm f/2D", 135, (1, 1.8)),
            ("planar_50mm_f1.4", "Sony Carl Zeiss Planar T* 50mm F1.4 ZA SSM (SALF0F14Z)", 50, (1, 1.8)),
            ("double_gauss_52mm_f1.8", "Canon EF 50mm f/1.8 MkII", 50, (1, 1.8)),
            ("fisheye_6.3mm_f2.8", "Nikon AI-S Fisheye-Nikkor 6mm f/2.8", 6, (0.5, 0.8))]


def measured(name, focal):
    """Distortion (a, b, c) and vignetting (k1, k2, k3) of a lens for full-frame film; None where not measured."""
    for file in glob.glob(os.path.join(folder, "*.xml")):
        for lens in ElementTree.parse(file).getroot().findall("lens"):
            calibration = lens.find("calibration")
            if name not in [one.text for one in lens.findall("model")] or float(lens.findtext("cropfactor")) > 1.01 or calibration is None:
                continue
            warp = light = None
            for one in calibration.findall("distortion"):
                if float(one.get("focal")) == focal and one.get("model") in ("ptlens", "poly3"):
                    # poly3 is ptlens with b alone.
                    warp = [float(one.get(k, 0)) for k in "abc"] if one.get("model") == "ptlens" else [0, float(one.get("k1")), 0]
            widest = None
            for one in calibration.findall("vignetting"):
                if float(one.get("focal")) == focal and float(one.get("distance")) >= 10:
                    if widest is None or float(one.get("aperture")) < widest:
                        widest = float(one.get("aperture"))
                        light = [float(one.get(k)) for k in ("k1", "k2", "k3")]
            return warp, light
    return None, None


def distortion(abc, q):
    a, b, c = abc
    return 100 * (a * q ** 3 + b * q ** 2 + c * q - a - b - c)


def illumination(k, r):
    return 1 + k[0] * r ** 2 + k[1] * r ** 4 + k[2] * r ** 6


print("| lens | measured lens | distortion at the edge, the corner, % | measured | light at 0.5, 0.75, 1 of the diagonal | measured |")
print("|---|---|---|---|---|---|")
worst_distortion = worst_light = 0
with tempfile.TemporaryDirectory() as out:
    for lens, name, focal, places in partners:
        run = subprocess.run([program, "export", lens, "--focus", "inf", "--wavelengths", "d", "--calibration", out, "--json"],
                             capture_output=True, text=True, check=True)
        models = {one["name"]: {v["name"]: v["value"] for v in one["values"]} for one in json.loads(run.stdout)["calibrations"]}
        warp, light = measured(name, focal)
        own = [models["lensfun_ptlens"][k] for k in "abc"]
        own_light = [models["lensfun_pa"][k] for k in ("k1", "k2", "k3")]
        # Relative to the centre, where a + b + c is the difference of the scales.
        cells = [lens, name]
        for abc in (own, warp):
            cells.append(" ".join(f"{distortion(abc, q) - distortion(abc, 0):+.2f}" for q in places) if abc else "")
        fisheye = "fisheye" in lens
        for k in (own_light, light):
            cells.append(" ".join(f"{illumination(k, r):.2f}" for r in (0.5, 0.75, 1)) if k and not fisheye else "")
        print("| " + " | ".join(cells) + " |")
        if warp:
            worst_distortion = max(worst_distortion, *(abs(distortion(own, q) - distortion(own, 0) - distortion(warp, q)
                                                           + distortion(warp, 0)) for q in places))
        if light and not fisheye:
            worst_light = max(worst_light, *(abs(illumination(own_light, r) - illumination(light, r)) for r in (0.5, 0.75, 1)))
print(f"\nLargest difference: distortion {worst_distortion:.2f} %, light {worst_light:.2f}")
sys.exit(1 if worst_distortion > 3 or worst_light > 0.25 or worst_light == 0 else 0)
