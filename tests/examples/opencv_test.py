# SPDX-License-Identifier: Apache-2.0
"""OpenCV reads the files of `petzval export` and puts scene points where the lens does.

    python3 opencv_test.py PETZVAL_PROGRAM FOLDER_OF_PETZVAL.PY
"""
import math
import os
import subprocess
import sys
import tempfile

program = sys.argv[1]
sys.path.insert(0, sys.argv[2])
try:
    import cv2
    import numpy
except ImportError as missing:
    print(missing)
    sys.exit(77)  # skipped
import petzval

failures = 0
for lens_name, limit in (("double_gauss_52mm_f1.8", 0.02), ("planar_50mm_f1.4", 0.2), ("biogon_35mm_f2.8", 0.2), ("fisheye_8mm_f2.8", 0.02)):
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([program, "export", lens_name, "--focus", "1km", "--wavelengths", "d", "--calibration", out, "--quiet"], check=True,
                       stdout=subprocess.DEVNULL)
        lens = petzval.Lens(lens_name).focus(1e6)
        camera = petzval.Camera(lens, petzval.Film(width_mm=36, height_mm=24, columns=1920, rows=1280), model="exact_double")
        pupil_z = lens.info.entrance_pupil_z_mm
        generator = numpy.random.default_rng(3)
        widest = 80 if "fisheye" in lens_name else 35
        field, azimuth = numpy.radians(widest * generator.random(500)), 2 * math.pi * generator.random(500)
        directions = numpy.stack([numpy.sin(field) * numpy.cos(azimuth), numpy.sin(field) * numpy.sin(azimuth), numpy.cos(field)], 1)
        # OpenCV: x to the right, y down, z forward.
        points = directions * [1, -1, -1] * (1e6 + pupil_z) + [0, 0, pupil_z]
        raster, visible = camera.project(points)
        seen = visible == 1
        for model in ("opencv_5", "opencv_8", "opencv_12", "opencv_fisheye"):
            file = os.path.join(out, f"{lens_name}.{model}.yml")
            if not os.path.exists(file):
                continue
            storage = cv2.FileStorage(file, cv2.FILE_STORAGE_READ)
            matrix, coefficients = storage.getNode("camera_matrix").mat(), storage.getNode("distortion_coefficients").mat()
            zero = numpy.zeros(3)
            own = directions[seen].reshape(-1, 1, 3)
            if model == "opencv_fisheye":
                found, _ = cv2.fisheye.projectPoints(own, zero, zero, matrix, coefficients)
            else:
                found, _ = cv2.projectPoints(own, zero, zero, matrix, coefficients)
            # OpenCV counts from the centre of the first pixel.
            error = numpy.linalg.norm(found.reshape(-1, 2) + 0.5 - raster[seen], axis=1)
            bad = error.max() > limit
            failures += bad
            print(f"{lens_name} {model}: {seen.sum()} points, largest difference {error.max():.5f} pixels{' FAILED' if bad else ''}")
sys.exit(1 if failures else 0)
