# SPDX-License-Identifier: Apache-2.0
"""Laws of petzval.py, with NumPy if installed: python3 python_test.py EXAMPLES_FOLDER"""
import math
import os
import subprocess
import sys
import tempfile

examples = sys.argv[1]
sys.path.insert(0, examples)
if len(sys.argv) > 2:  # as if NumPy were not installed
    sys.modules["numpy"] = None
import petzval

failures = []


def expect(condition, what):
    if not condition:
        failures.append(what)
        print("FAILED:", what)


lens = petzval.Lens("double_gauss_100mm_f2.0").f_number(2.8).focus(3000, "film")
expect(abs(lens.info.f_number - 2.8) < 1e-9, "f-number")
expect(abs(lens.info.focal_length_mm - 100.7) < 0.05, "focal length")
expect(len(lens.surfaces) == lens.info.surface_count, "surfaces")
expect(petzval.Lens("double_gauss_100mm_f2.0").prescription.startswith("{"), "prescription")
report = lens.report([0, 5])
expect(report["f_number"] == lens.info.f_number and [w["field_deg"] for w in report["wavefront"]] == [0, 5], "report")
film = petzval.Film(columns=600, rows=400)
camera = petzval.Camera(lens, film, frame="pbrt", origin="film", model="exact_double")
count = 1000
u = [(i + 0.5) / count for i in range(count)]
v = [(i * 0.6180339887) % 1 for i in range(count)]
rays = camera.sample([600 * b for b in v], [400 * a for a in u], v, u)
lengths = [math.sqrt(x * x + y * y + z * z) for x, y, z in zip(rays["dx"], rays["dy"], rays["dz"])]
expect(all(abs(one - 1) < 1e-6 for one in lengths), "directions of unit length")
expect(sum(1 for w in rays["weights"] if w > 0) > 0.8 * count, "rays pass")
expect(all(z > 0 for z in rays["dz"]), "pbrt's cameras look along +z")
again = petzval.Camera.read(camera.write()).sample([600 * b for b in v], [400 * a for a in u], v, u)
expect(all(list(rays[name]) == list(again[name]) for name in rays), "a written camera has the same rays")
point = (0.3, 0.1, 3.0)
found = camera.connect([point] * count, u, v)
(raster,), (seen,) = ([list(map(float, camera.project([point])[0][:2]))] if petzval.numpy is None
                      else camera.project([point])[0].tolist()), camera.project([point])[1]
expect(seen == 1 and abs(raster[0] - 300 - 180) < 10 and raster[1] < 200, "the point is on the right, above the centre")
weights = [we / pdf if pdf > 0 else 0 for we, pdf in zip(found["we"], found["pdf"])]
mean_x = sum(w * x for w, x in zip(weights, found["raster_x"])) / sum(weights)
expect(abs(mean_x - raster[0]) < 1, "connections meet the film where the point projects")
x, y, w = petzval.Camera(lens, film).spot((0, 0, -2800), 500)
expect(len(x) > 400 and max(abs(a) for a in x) < 0.3, "spot")
psf, image = petzval.Camera(lens, film).point_image((0, 100, -2900), pixels=16, samples=1 << 12)
total = float(image.sum()) if petzval.numpy is not None else sum(image)
expect(abs(total - psf.throughput) < 1e-4, "the PSF contains the throughput")
rays = petzval.LensRays(camera, count=20, threads=2)
info = rays.info(1000, math.inf)
expect((rays.columns, rays.rows) == (600, 400) and 0 < info.offset_px < 100, "facts of lens rays")
wide, high = 600, 400
grey, alone = [0.25, 0.25, 0.25, 1] * (wide * high), [3000.0] * (wide * high)
layers, blur = petzval.Layers(wide, high, [(grey, alone)]), petzval.Blur()
seen = []
whole = blur.gather(layers, rays, progress=lambda done: seen.append(done))
numbers = whole.ravel().tolist() if petzval.numpy is not None else list(whole)
expect(len(numbers) == 4 * wide * high and seen[0] == 0 and sorted(seen) == seen and seen[-1] == 1, "a picture with progress")
centre = 4 * (wide * 200 + 300)
expect(abs(numbers[centre] / numbers[centre + 2] - 1) < 1e-6 and numbers[centre + 3] == 1, "grey stays grey")
part = blur.gather(petzval.Layers.deep(wide, high, [[(3000, 0.25, 0.25, 0.25, 1)]] * (wide * high), info.bias, 2), rays,
                   region=(300, 200, 1, 1), highlights_above=math.inf, threads=2)
expect(list(part.ravel() if petzval.numpy is not None else part) == numbers[centre:centre + 4], "a region of a deep image")
for wrong in (lambda: blur.gather(layers, rays, progress=lambda done: True), lambda: blur.gather(layers, rays, region=(599, 0, 2, 1)),
              lambda: petzval.Layers(wide, high, [(grey, alone[1:])]), lambda: petzval.Layers.deep(2, 1, [[(1, 2)]] * 2, 0, 1),
              lambda: petzval.Lens("missing.json"), lambda: lens.copy().f_number(0.5), lambda: lens.copy().f_number(math.nan),
              lambda: petzval.Camera(lens, model="best"), lambda: petzval.Camera.read(b"{}"),
              lambda: petzval.Camera(lens, frame="cube"), lambda: camera.sample([1], [1, 2], [0], [0]),
              lambda: petzval.Film(width=24), lambda: petzval.Film(columns=2 ** 33), lambda: camera.project([1, 2, 3, 4]),
              lambda: petzval.Camera(lens, near=100), lambda: camera.point_image((0, 0, -2000), samples=-1)):
    try:
        wrong()
        expect(False, "a bad argument raises petzval.Error")
    except petzval.Error as error:
        expect(str(error) != "", "the error has a message")
try:
    blur.gather(layers, rays, progress=lambda done: 1 // 0)
    expect(False, "an error of progress() is raised")
except ZeroDivisionError:
    pass
expect(petzval.Camera(lens, model=lens.choose_model(max_px=2).model).info.model != "", "a chosen model makes a camera")
expect(petzval.Film(z_mm=70).has_z == 1, "a position of the film is used")
if petzval.numpy is not None:
    own = petzval.numpy.array([0.5])
    expect(petzval._numbers(own)[2] is own, "float64 arrays are passed without copies")

with tempfile.TemporaryDirectory() as folder:
    for command in (["autofocus.py"], ["spots.py", "tessar_100mm_f2.8", os.path.join(folder, "spots.png")],
                    ["psf_stack.py", "tessar_100mm_f2.8", os.path.join(folder, "stack"), "4"]):
        if petzval.numpy is None:
            break
        run = subprocess.run([sys.executable, os.path.join(examples, command[0])] + command[1:], capture_output=True, text=True)
        expect(run.returncode == 0, f"{command[0]}: {run.stderr}")
    if petzval.numpy is not None and not failures:
        load = lambda name: petzval.numpy.load(os.path.join(folder, "stack", name + ".npy"))
        expect(load("psf").shape == (4, 3, 64, 64), "layout of psf.npy")
        expect(abs(load("psf").sum(axis=(2, 3)) - 1).max() < 1e-4, "PSFs have the sum 1")
        light, distortion = load("illumination"), load("distortion")
        expect(light[0] == 1 and 0 < light[3] < light[1] < 1, "illumination falls to the edge")
        expect(distortion[0] == 0 and abs(distortion).max() < 0.1, "distortion")
try:
    import OpenImageIO
except ImportError:
    OpenImageIO = None
if petzval.numpy is not None and OpenImageIO is not None:
    with tempfile.TemporaryDirectory() as folder:
        paths = [os.path.join(folder, name) for name in ("sharp.exr", "blurred.exr")]
        spec = OpenImageIO.ImageSpec(48, 32, 5, OpenImageIO.FLOAT)
        spec.channelnames = ("R", "G", "B", "A", "Z")
        sharp = OpenImageIO.ImageBuf(spec)
        pixels = petzval.numpy.full((32, 48, 5), 1, petzval.numpy.float32)
        pixels[:, 24:] = (0, 0, 0, 1, 9)
        sharp.set_pixels(OpenImageIO.ROI.All, pixels)
        sharp.write(paths[0])
        run = subprocess.run([sys.executable, os.path.join(examples, "blur_exr.py")] + paths + ["double_gauss_52mm_f1.8", "9000"],
                             capture_output=True, text=True)
        row = OpenImageIO.ImageBuf(paths[1]).get_pixels(OpenImageIO.FLOAT)[16, :, 0] if run.returncode == 0 else [0, 1]
        expect(run.returncode == 0 and 0 == row[40] < row[24] < row[23] < row[22], f"blur_exr.py: {run.stderr}")
sys.exit(1 if failures else 0)
