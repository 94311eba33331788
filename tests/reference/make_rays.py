#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes rays.csv: rays traced through lenses of data/lenses at the d line with 60 digits.

    python3 tests/reference/make_rays.py            (needs python3-mpmath)

It shares no formula with the library. Quadrics are intersected in the frame of their centre (paraboloids in the frame of an axis):
both roots are computed, and the hit is the root on the sheet through the vertex, crossed in the direction of travel. Aspheres are
scanned densely for their first crossing, which mpmath.findroot refines. Refraction is Snell's law by angles in the plane of
incidence. A ray is skipped if its fate changes within a few 1e-5, so that fates can be compared exactly, also in float.
"""
import json
import math
import pathlib
import random

from mpmath import asin, cos, findroot, mp, mpf, pi, sin, sqrt

HERE = pathlib.Path(__file__).resolve().parent
LENSES = HERE.parent.parent / "data" / "lenses"
DIGITS = 60
MARGIN = mpf("3e-5")
NAMES = """double_gauss_100mm_f1.35 double_gauss_100mm_f2.0 fisheye_10mm_f4 fisheye_6.3mm_f2.8 modern_58mm_f0.95
    phone_5.6mm_f3.5 anamorphic_60mm_2x catadioptric_mangin_1000mm_f7.5 catadioptric_maksutov_1280mm_f14.4
    mirror_ritchey_chretien_57.6m_f24 eye_gullstrand_le_grand ball_10mm cylinder_3.9mm
    analytic_plano_hyperbolic_100mm""".split()


class Doubtful(Exception):
    """Rounding decides the fate of the ray."""


class Lost(Exception):
    pass


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def along(p, d, t):
    return [x + t * y for x, y in zip(p, d)]


def unit(v):
    length = sqrt(dot(v, v))
    return [x / length for x in v]


class Surface:
    def __init__(self, row, z):
        self.z = z
        self.radius = mpf(row["radius"])
        self.conic = mpf(row["conic"])
        self.terms = [(t["order"], mpf(t["coefficient"])) for t in row["aspheric"]]
        self.section = {"x": (1, 0), "y": (0, 1)}.get(row.get("curved_in"), (1, 1))
        self.rim = mpf(row["semi_diameter"]) if row.get("semi_diameter") is not None else None
        self.hole = mpf(row.get("inner_semi_diameter") or 0)
        self.mirror = row.get("mirror", False)
        self.stop = row["stop"]

    def sag(self, r):
        """Sag and slope dz/dr; None beyond the equator."""
        z = slope = mpf(0)
        if self.radius != 0:
            inside = self.radius ** 2 - (1 + self.conic) * r * r
            if inside <= 0:
                return None
            root = sqrt(inside)
            z = r * r / (self.radius + mp.sign(self.radius) * root)
            slope = mp.sign(self.radius) * r / root
        return (z + sum(a * r ** n for n, a in self.terms), slope + sum(n * a * r ** (n - 1) for n, a in self.terms))

    def normal(self, p):
        """Unit normal, towards +z at the vertex."""
        ax, ay = self.section
        if self.terms:
            r = sqrt(ax * p[0] ** 2 + ay * p[1] ** 2)
            slope = self.sag(r)[1]
            return unit([-slope * ax * p[0] / r, -slope * ay * p[1] / r, mpf(1)]) if r != 0 else [mpf(0), mpf(0), mpf(1)]
        if self.radius == 0:
            return [mpf(0), mpf(0), mpf(1)]
        # Minus half the gradient of x^2 + y^2 + (1 + k) z^2 - 2 R z, times the sign of R, so that it points to +z at the vertex.
        g = [-ax * p[0], -ay * p[1], self.radius - (1 + self.conic) * p[2]]
        return unit([mp.sign(self.radius) * x for x in g])

    def quadric_hit(self, p, d, sense):
        if self.radius == 0:
            if d[2] * sense <= 0:
                raise Lost
            return along(p, d, -p[2] / d[2])
        ax, ay = self.section
        e = 1 + self.conic
        if e != 0:  # centre at z = R / e:  ax x^2 + ay y^2 + e (z - R/e)^2 = R^2 / e
            q = [p[0], p[1], p[2] - self.radius / e]
            a = ax * d[0] ** 2 + ay * d[1] ** 2 + e * d[2] ** 2
            b = ax * q[0] * d[0] + ay * q[1] * d[1] + e * q[2] * d[2]
            c = ax * q[0] ** 2 + ay * q[1] ** 2 + e * q[2] ** 2 - self.radius ** 2 / e
        else:  # paraboloid: ax x^2 + ay y^2 = 2 R z
            a = ax * d[0] ** 2 + ay * d[1] ** 2
            b = ax * p[0] * d[0] + ay * p[1] * d[1] - self.radius * d[2]
            c = ax * p[0] ** 2 + ay * p[1] ** 2 - 2 * self.radius * p[2]
        if abs(a) < mpf(10) ** -40:
            roots = [-c / (2 * b)] if b != 0 else []
        else:
            inside = b * b - a * c
            if abs(inside) < MARGIN * b * b:
                raise Doubtful
            roots = [] if inside < 0 else [(-b - sqrt(inside)) / a, (-b + sqrt(inside)) / a]
        for t in roots:
            hit = along(p, d, t)
            height = 1 - e * hit[2] / self.radius  # > 0 on the half that holds the vertex
            if abs(height) < MARGIN:
                raise Doubtful
            if height > 0 and dot(self.normal(hit), d) * sense > 0:
                return hit
        raise Lost

    def asphere_hit(self, p, d, sense):
        """The first crossing in the direction of travel within the clear aperture."""
        q = along(p, d, -dot(p, d))
        px, py, pz, dx, dy, dz = map(float, q + d)
        rim = float(self.rim)

        def height(t):
            return math.hypot(px + t * dx, py + t * dy)

        def clearance(t):
            return pz + t * dz - float(self.sag(mpf(height(t)))[0])

        def exact(t):
            x = along(q, d, t)
            return x[2] - self.sag(sqrt(x[0] ** 2 + x[1] ** 2))[0]

        steps = 600
        ts = [3 * rim * (2 * i / steps - 1) for i in range(steps + 1)]
        with mp.workdps(15):
            values = [clearance(t) if height(t) <= rim else None for t in ts]
        for i in range(steps):
            f, g = values[i], values[i + 1]
            if f is not None and g is not None and f * sense < 0 <= g * sense:
                t = findroot(exact, (mpf(ts[i]), mpf(ts[i + 1])), solver="anderson", tol=mpf(10) ** -90, maxsteps=200)
                hit = along(q, d, t)
                if abs(dot(self.normal(hit), d)) < mpf("0.02"):
                    raise Doubtful  # grazing: another crossing may be within rounding
                return hit
        raise Doubtful  # lost beyond the rim, where either fate is correct

    def hit(self, p, d, sense):
        return self.asphere_hit(p, d, sense) if self.terms else self.quadric_hit(p, d, sense)


class Lens:
    def __init__(self, name):
        rows = json.loads((LENSES / f"{name}.json").read_text())["surfaces"]
        self.name = name
        self.surfaces, z = [], mpf(0)
        for row in rows:
            self.surfaces.append(Surface(row, z))
            z += mpf(row["thickness"])
        self.film_z = z
        self.index = [mpf(1)] + [mpf(row["nd"]) for row in rows]  # index[i] before, index[i + 1] behind surface i

    def stop(self):
        return next(i for i, s in enumerate(self.surfaces) if s.stop)

    def trace(self, p, d, travel, first=0, last=None, apertures=True):
        """(fate, surface, point, direction) through surfaces [first, last)."""
        last = len(self.surfaces) if last is None else last
        forward = travel == "to_film"
        sense = 1 if forward else -1
        for s in self.surfaces[: first if forward else last]:
            sense = -sense if s.mirror else sense
        d = unit(d)
        done = -1
        for i in range(first, last) if forward else range(last - 1, first - 1, -1):
            s = self.surfaces[i]
            try:
                hit = s.hit([p[0], p[1], p[2] - s.z], d, sense)
            except Lost:
                return "missed_surface", i, p, d
            p = [hit[0], hit[1], hit[2] + s.z]
            r = sqrt(hit[0] ** 2 + hit[1] ** 2)
            for rim in (s.rim, s.hole):
                if apertures and rim and abs(r - rim) < MARGIN * rim:
                    raise Doubtful
            if apertures and (s.rim is not None and r > s.rim or r < s.hole):
                return "vignetted", i, p, d
            n = s.normal(hit)
            c = dot(n, d)
            if s.mirror:
                d = unit(along(d, n, -2 * c))
                sense = -sense
            else:
                before, behind = (self.index[i], self.index[i + 1]) if forward else (self.index[i + 1], self.index[i])
                across = along(d, n, -c)  # component along the surface, length sin I
                sine = sqrt(dot(across, across))
                refracted = before / behind * sine
                if abs(refracted - 1) < MARGIN:
                    raise Doubtful
                if refracted > 1:
                    return "totally_reflected", i, p, d
                angle = asin(refracted)
                forwards = [mp.sign(c) * cos(angle) * x for x in n]
                d = along(forwards, across, sin(angle) / sine) if sine > mpf(10) ** -50 else d
            done = i
        return "transmitted", done, p, d


def rounded(v):
    return [float(x) for x in v]


def through_stop(lens, rng, spread, side):
    """A ray from a point of the stop to one side of the lens, reversed: most of these rays pass."""
    i = lens.stop()
    s = lens.surfaces[i]
    radius, turn = float(s.rim) * math.sqrt(rng.random()) * 0.999, 2 * math.pi * rng.random()
    slope, heading = math.radians(spread) * math.sqrt(rng.random()), 2 * math.pi * rng.random()
    x, y = radius * math.cos(turn), radius * math.sin(turn)
    sag = s.sag(mpf(radius))
    if sag is None:
        return None
    d = [math.sin(slope) * math.cos(heading), math.sin(slope) * math.sin(heading), math.cos(slope)]
    if side == "scene":  # through the surfaces in front of the stop
        part, travel, towards = (0, i), "to_scene", -1
        mirrors = sum(t.mirror for t in lens.surfaces[:i])
    else:
        part, travel, towards = (i + 1, len(lens.surfaces)), "to_film", 1
        mirrors = sum(t.mirror for t in lens.surfaces[: i + 1])
    towards *= (-1) ** mirrors
    fate, _, p, d = lens.trace([x, y, sag[0] + s.z], [towards * v for v in d], travel, *part)
    if fate != "transmitted":
        return None
    back = rng.uniform(1, 30)
    return rounded(along(p, d, back)), rounded(-v for v in d)


def at_random(lens, rng, travel, spread):
    """A ray that starts at an outer surface; many of these rays are lost."""
    forward = travel == "to_film"
    s = lens.surfaces[0 if forward else -1]
    reach = float(s.rim) * 1.15
    mirrors = sum(t.mirror for t in lens.surfaces)
    towards = 1 if forward else -((-1) ** mirrors)
    radius, turn = reach * math.sqrt(rng.random()), 2 * math.pi * rng.random()
    slope, heading = math.radians(spread) * rng.random(), 2 * math.pi * rng.random()
    d = [math.sin(slope) * math.cos(heading), math.sin(slope) * math.sin(heading), towards * math.cos(slope)]
    return rounded(along([radius * math.cos(turn), radius * math.sin(turn), float(s.z)], d, -rng.uniform(1, 30))), rounded(d)


def rays(lens, rng):
    mirrors = sum(s.mirror for s in lens.surfaces)
    film_sense = (-1) ** mirrors
    yield "to_film", [0.0, 0.0, -10.0], [0.0, 0.0, 1.0]
    yield "to_scene", [0.0, 0.0, float(lens.film_z)], [0.0, 0.0, -1.0 * film_sense]
    steep = 2.0 if mirrors else 30.0
    hard = "fisheye" in lens.name or "mangin" in lens.name  # few random rays pass these lenses
    for k in range(200 if hard else 60):
        ray = through_stop(lens, rng, steep if k % 3 else steep / 4, "scene" if k % 3 else "film")
        if ray:
            yield "to_film" if k % 3 else "to_scene", *ray
    for k in range(24):
        travel = "to_film" if k % 2 else "to_scene"
        yield travel, *at_random(lens, rng, travel, 4.0 if mirrors else 75.0)


def main():
    mp.dps = DIGITS
    lines = [
        "# SPDX-License-Identifier: Apache-2.0",
        "# Rays through lenses of data/lenses at the d line. Origin: this project, licence Apache-2.0.",
        f"# Written by tests/reference/make_rays.py (mpmath, {DIGITS} digits); regenerate with: python3 tests/reference/make_rays.py",
        "# Inputs are exact doubles in shortest decimals; results are rounded once to double. Millimetres, lens frame, surfaces from 0.",
        "# The result is the hit on the last surface reached and the direction behind it, or before it where the ray is lost there.",
        "lens,travel,x,y,z,dx,dy,dz,fate,surface,out_x,out_y,out_z,out_dx,out_dy,out_dz",
    ]
    for number, name in enumerate(NAMES):
        lens = Lens(name)
        rng = random.Random(1000 + number)
        kept = {}
        for travel, p, d in rays(lens, rng):
            try:
                fate, surface, q, e = lens.trace([mpf(v) for v in p], [mpf(v) for v in d], travel)
            except Doubtful:
                continue
            kind = travel, fate, surface if fate != "transmitted" else 0
            kept[kind] = kept.get(kind, 0) + 1
            if kept[kind] > (20 if fate == "transmitted" else 3):
                continue
            values = [name, travel, *map(repr, p + d), fate, str(surface), *map(repr, rounded(q) + rounded(e))]
            lines.append(",".join(values))
        print(name, {k[:2]: sum(v for j, v in kept.items() if j[:2] == k[:2]) for k in kept}, flush=True)
    (HERE / "rays.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
