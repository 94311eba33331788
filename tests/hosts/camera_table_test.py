# SPDX-License-Identifier: Apache-2.0
"""Reads the tables of `petzval export --camera` by lib/docs/camera_table.md alone, and traces rays in double.

    python3 camera_table_test.py PETZVAL_PROGRAM FOLDER_OF_PETZVAL.PY PETZVAL_CAMERA.H
"""
import json
import math
import os
import re
import subprocess
import sys
import tempfile

program, header = sys.argv[1], sys.argv[3]
sys.path.insert(0, sys.argv[2])
try:
    import numpy
except ImportError as missing:
    print(missing)
    sys.exit(77)  # skipped
import petzval


class Table:
    """The rays of a lens of revolution with a round stop, from the film to the scene."""

    def __init__(self, positions, numbers):
        self.at, self.t = positions, numbers.astype(float)

    def whole(self, name):
        return int(self.t[self.at[name]])

    def pupil(self, film, u, v):
        """A point of the pupil of a film point, and the area that the sample represents."""
        r = math.hypot(*film)
        place = r * self.t[self.at["rows_per_mm"]]
        row = min(int(place), self.whole("film_cells_1") - 1)
        t = place - row
        size = self.whole("film_node_size")
        near, far = self.t[self.whole("film_nodes") + row * size:][:2 * size].reshape(2, size)
        node = near + t * (far - near)
        corners = node[2:132].reshape(65, 2)
        sine, cosine = (film[0] / r, film[1] / r) if r > 0 else (0, 1)
        turns = (u - math.atan2(sine, cosine) / (2 * math.pi)) % 1 * 64
        k = min(int(turns), 63)
        a, b = corners[k], corners[k + 1]
        px, py = node[:2] + math.sqrt(v) * (a + (turns - k) * (b - a))
        return numpy.array([cosine * px + sine * py, cosine * py - sine * px]), 32 * (b[0] * a[1] - a[0] * b[1])

    def sag(self, surface, u):
        c, e, aspheric = surface[2], surface[3], int(surface[10])
        z = c * u / (1 + numpy.sqrt(1 - e * c * c * u))
        if aspheric:
            height, _, terms, step = self.t[aspheric:aspheric + 4]
            for i in range(int(terms)):
                z += self.t[aspheric + 4 + i] * (numpy.sqrt(u) / height) ** (2 + step * i)
        return z

    def ray(self, film, u, v):
        """Origin, direction and weight, or None."""
        pupil, area = self.pupil(film, u, v)
        film_z, pupil_z = self.t[self.at["film_z"]], self.t[self.at["pupil_z"]]
        path = numpy.array([*(pupil - film), pupil_z - film_z])
        weight = self.t[self.whole("numbers")] * area * path[2] ** 2 / (path @ path) ** 2
        p, d = numpy.array([*pupil, pupil_z]), path / math.sqrt(path @ path)
        d = d if d[2] < 0 else -d
        count = self.whole("surface_count")
        surfaces = self.t[self.whole("surfaces"):][:12 * count].reshape(count, 12)
        squares = self.t[self.whole("numbers") + 4:][:count + 1]
        for i in reversed(range(count)):
            s = surfaces[i]
            p = p + (s[0] - p[2]) / d[2] * d  # to the vertex plane
            way = 0.0
            for _ in range(60):  # secant along z
                q = p + way * d
                step = (s[0] + self.sag(s, q[0] ** 2 + q[1] ** 2) - q[2]) / d[2]
                way += step
                if abs(step) < 1e-13:
                    break
            p = p + way * d
            u2 = p[0] ** 2 + p[1] ** 2
            if u2 > s[6]:
                return None
            h = 1e-6
            slope = (self.sag(s, (math.sqrt(u2) + h) ** 2) - self.sag(s, max(math.sqrt(u2) - h, 0) ** 2)) / (2 * h) if u2 > h * h else 0
            normal = numpy.array([-slope * p[0], -slope * p[1], math.sqrt(u2)]) / math.sqrt(u2) if u2 > h * h else numpy.array([0, 0, 1.0])
            normal /= numpy.linalg.norm(normal)
            ratio, cosine = math.sqrt(squares[i + 1] / squares[i]), -(normal @ d)
            d = ratio * d + (ratio * cosine - math.copysign(math.sqrt(1 - ratio ** 2 * (1 - cosine ** 2)), cosine)) * normal
        if self.whole("front_first") == 0:  # go on to the front: |c p|^2 = 2 p_z from its vertex
            c, o = self.t[self.at["front_curvature"]], p - [0, 0, self.t[self.at["front_z"]]]
            a, b, e = c, c * (o @ d) - d[2], c * (o @ o) - 2 * o[2]
            p = p + (-e / (b + math.sqrt(b * b - a * e))) * d
        return p, d, weight


failures = 0
for name in ("double_gauss_100mm_f2.0", "phone_5.6mm_f3.5", "retrofocus_100mm_f2.8"):
    with tempfile.TemporaryDirectory() as folder:
        for ending in ("json", "bin"):
            subprocess.run([program, "export", name, "--focus", "inf", "--film", "6x4", "--camera", os.path.join(folder, "t." + ending), "--quiet"],
                           check=True, stdout=subprocess.DEVNULL)
        with open(os.path.join(folder, "t.json")) as file:
            named = json.load(file)
        numbers = numpy.fromfile(os.path.join(folder, "t.bin"), "<f4")
    failures += not numpy.array_equal(numbers, numpy.array(named["table"], "f4"))
    failures += numbers[0] != 7 or numbers[1] != len(numbers)
    defined = {n.lower(): int(p) for n, p in re.findall(r"#define PZ_([A-Z_]+) (\d+)", open(header).read())}
    failures += any(defined.get(n, p) != p for n, p in named["positions"].items() if n != "format")
    table = Table(named["positions"], numbers)
    lens = petzval.Lens(name).focus(math.inf)
    camera = petzval.Camera(lens, petzval.Film(width_mm=6, height_mm=4), model="exact_double")
    generator = numpy.random.default_rng(5)
    x, y, u, v = generator.random((4, 300))
    columns, rows = numbers[table.at["columns"]], numbers[table.at["rows"]]
    wanted = camera.sample(x * columns, y * rows, u, v)
    largest = lit = lost = 0
    for i in range(300):
        film = numpy.array([(0.5 - x[i]) * 6, (y[i] - 0.5) * 4])
        found = table.ray(film, u[i], v[i])
        if (found is None) != (wanted["weights"][i] == 0):
            lost += 1
        elif found is not None:
            lit += 1
            origin, direction = ([wanted[k][i] for k in names] for names in (("x", "y", "z"), ("dx", "dy", "dz")))
            largest = max(largest, abs(found[1] - direction).max(), abs(found[0] - origin).max() / 100,
                          abs(found[2] / wanted["weights"][i] - 1) / 10)
    bad = largest > 3e-6 or lost > 1 or lit < 200
    failures += bad
    print(f"{name}: {lit} rays, largest difference {largest:.1e} (radians, 100 mm, weight by 10), {lost} other fates{' FAILED' if bad else ''}")
sys.exit(1 if failures else 0)
