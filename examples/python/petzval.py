# SPDX-License-Identifier: Apache-2.0
"""Lenses and cameras of petzval in Python, through its C interface (petzval/petzval.h). Needs no other package.

    import petzval
    lens = petzval.Lens("double_gauss_52mm_f1.8").f_number(2.8).focus(3000)
    camera = petzval.Camera(lens, petzval.Film(width_mm=36, height_mm=24, columns=1920, rows=1280))
    rays = camera.sample(raster_x, raster_y, pupil_u, pupil_v)      # arrays of N numbers
    psf, image = camera.point_image((0, 300, -3000))

Arrays are NumPy arrays if NumPy is installed: given arrays of float64 (wavelengths: float32) are passed without copies,
and results are written into new NumPy arrays. Without NumPy, results are array.array. Lengths are in mm and rays in the
lens frame (right-handed, the scene at negative z) unless stated otherwise. A failed call raises petzval.Error.

The library is looked for in PETZVAL_LIBRARY (path of libpetzval-c.so), on the system, and in the build folder.
"""
import array
import ctypes
import ctypes.util
import itertools
import json
import os

try:
    import numpy
except ImportError:
    numpy = None

c_double, c_float, c_int32, c_int64, c_size = ctypes.c_double, ctypes.c_float, ctypes.c_int32, ctypes.c_int64, ctypes.c_size_t
VERSION = 1


class Error(Exception):
    """A failed call: `status` as in petzval.h, and the message of the library."""

    def __init__(self, status, message):
        super().__init__(message)
        self.status = status


def _library():
    here = os.path.dirname(os.path.abspath(__file__))
    build = os.path.join(here, "..", "..", "build", "lib", "libpetzval-c.so")
    for name in (os.environ.get("PETZVAL_LIBRARY"), ctypes.util.find_library("petzval-c"), build):
        if name and (os.path.exists(name) or not os.path.isabs(name)):
            return ctypes.CDLL(name)
    raise ImportError("libpetzval-c.so was not found; set PETZVAL_LIBRARY to its path")


_c = _library()
_c.petzval_message.restype = ctypes.c_char_p
_c.petzval_data_directory.restype = ctypes.c_char_p
_c.petzval_glasses_count.restype = c_size
for _name in ("glasses", "lens", "camera", "lens_rays", "layers", "blur"):
    getattr(_c, f"petzval_{_name}_free").argtypes = [ctypes.c_void_p]
    getattr(_c, f"petzval_{_name}_free").restype = None


def _call(name, *arguments):
    status = getattr(_c, "petzval_" + name)(*arguments)
    if status != 0:
        raise Error(status, _c.petzval_message().decode())


class _Struct(ctypes.Structure):
    """A struct of petzval.h; members with `size` get their size. Keywords set members."""

    def __init__(self, **members):
        names = [name for name, *_ in self._fields_]
        for name in members:
            if name not in names or name == "size":
                raise Error(1, f"{name} is no member of {type(self).__name__}; must be one of {', '.join(names)}")
        super().__init__(**members)
        for name, value in members.items():
            if isinstance(value, int) and getattr(self, name) not in (value, None):
                raise Error(1, f"{name} = {value} is out of range")
        if names[0] == "size":
            self.size = ctypes.sizeof(self)
        if "z_mm" in members and "has_z" in names and "has_z" not in members:
            self.has_z = 1

    def __getattribute__(self, name):
        value = super().__getattribute__(name)
        return value.decode() if isinstance(value, bytes) else value

    def __repr__(self):
        return f"{type(self).__name__}({', '.join(f'{n}={getattr(self, n)!r}' for n, *_ in self._fields_ if n not in ('size', 'unused'))})"


_Progress = ctypes.CFUNCTYPE(c_int32, c_double, ctypes.c_void_p)


def _struct(name, text):
    """Makes a struct from lines "type member member[3] ..." in the order of petzval.h."""
    types = {"double": c_double, "int32": c_int32, "int64": c_int64, "uint32": ctypes.c_uint32, "size": c_size,
             "char": ctypes.c_char, "text": ctypes.c_char_p, "pointer": ctypes.c_void_p, "callback": _Progress}
    fields = []
    for line in text.split(";"):
        kind, *members = line.split()
        for member in members:
            member, _, count = member.partition("[")
            fields.append((member, types[kind] * int(count[:-1]) if count else types[kind]))
    return type(name, (_Struct,), {"_fields_": fields})


Glass = _struct("Glass", "size size; char catalogue[32] name[64]; double nd vd shortest_nm longest_nm")
LensInfo = _struct("LensInfo", "size size; double focal_length_mm f_number film_z_mm rear_focal_z_mm front_principal_z_mm"
                   " rear_principal_z_mm entrance_pupil_z_mm entrance_pupil_diameter_mm exit_pupil_z_mm exit_pupil_diameter_mm"
                   " declared_half_field_deg declared_f_number image_diagonal_mm squeeze;"
                   "int64 surface_count wavelength_count primary_wavelength stop; double index_error;"
                   "int32 has_cylinders has_moving_groups")
Surface = _struct("Surface", "size size; double vertex_z_mm thickness_mm curvature conic semi_diameter_mm index_before index_after;"
                  "int32 mirror aspheric_terms stop section")
Film = _struct("Film", "size size; double width_mm height_mm; int32 columns rows; double shift_x_mm shift_y_mm margin_mm tilt_rad"
               " swing_rad z_mm; int32 has_z unused")
FilmFit = _struct("FilmFit", "size size; double rms_mm; int32 limited upright")
Choice = _struct("Choice", "size size; char model[32]; double max_px exposure pupil_shape ns_per_ray; char reasons[1024]")
CameraInfo = _struct("CameraInfo", "size size; char model[32]; double film_width_mm film_height_mm film_z_mm film_area_mm2;"
                     "int32 columns rows; double units_per_mm shortest_nm longest_nm; int64 wavelength_count")
Psf = _struct("Psf", "size size; double pixel_mm centre_mm[2] centroid_mm[2] rms_radius_mm max_radius_mm throughput error;"
              "int32 pixels wavelengths")
_LensOptions = _struct("_LensOptions", "size size; pointer wavelengths_nm; size wavelength_count; double primary_nm; pointer glasses;"
                       "int32 clamp_wavelengths require_glasses configuration strict; text entry")
_Requirements = _struct("_Requirements", "size size; double near_mm far_mm max_px max_of_blur exposure pupil_shape; int32 threads unused")
_CameraOptions = _struct("_CameraOptions", "size size; text model; int32 normalisation frame origin threads; double units_per_mm;"
                         "int32 clamp_wavelengths importance_tables; double near_mm far_mm; int32 near_far_origin keep_light;"
                         "double lens_ratio rate_of_change weight_distribution weight_strength")
_PsfOptions = _struct("_PsfOptions", "size size; uint32 samples; int32 pixels; double half_width_mm centre_mm[2]; int32 has_centre threads;"
                      "uint32 seed; int32 distant")
_FocusPoint = _struct("_FocusPoint", "double position_mm[3] blur_mm weight")
_Importance = _struct("_Importance", "double raster_x raster_y we pdf_position pdf_direction; int32 fate unused")
_Connection = type("_Connection", (_Struct,), {"_fields_": [
    ("direction", c_double * 3), ("distance", c_double), ("on_front", c_double * 3), ("pdf", c_double), ("importance", _Importance)]})
_Samples = _struct("_Samples", "pointer raster_x raster_y pupil_u pupil_v wavelengths_nm times")
_Rays = _struct("_Rays", "pointer x y z dx dy dz weights fates pdf_pupil pdf_direction")

RaysInfo = _struct("RaysInfo", "size size; double focal_px axis_px[2] pinhole_z_mm reach_px offset_px bias; int32 columns rows overscan"
                   " most_layers")
_RaysOptions = _struct("_RaysOptions", "size size; int32 count set_count over_pixels threads; double nearest_mm; pointer rgb_nm")
_GatherOptions = _struct("_GatherOptions", "size size; int32 left top columns rows threads unused; double highlights_above;"
                         "callback progress; pointer user")

ORIGINS = {"front_vertex": 0, "film": 1, "entrance_pupil": 2}
FRAMES = {"lens": 0, "pbrt": 1, "mitsuba": 2, "arnold": 3}
NORMALISATIONS = {"irradiance": 0, "unity_on_axis": 1, "unity_at_each_wavelength": 2}


def _choice(table, name, what):
    if name not in table:
        raise Error(1, f"{what} = {name!r}; must be one of {', '.join(table)}")
    return table[name]


def _numbers(values, code="d"):
    """(pointer, count, owner): an array of doubles ("d") or floats ("f"), without a copy if it is one already."""
    if numpy is not None:
        own = numpy.ascontiguousarray(values, dtype=numpy.float64 if code == "d" else numpy.float32)
        return own.ctypes.data, own.size, own
    flat = values if isinstance(values, array.array) and values.typecode == code else array.array(code, _flat(values))
    return flat.buffer_info()[0], len(flat), flat


def _points(values):
    """(pointer, number of points, owner) of an array [N, 3], or of one point."""
    if numpy is not None:
        shape = numpy.shape(values)
        if shape[-1:] != (3,) or len(shape) > 2:
            raise Error(1, f"points have the shape {shape}; must be (N, 3)")
    pointer, count, owner = _numbers(values)
    if count % 3 != 0:
        raise Error(1, f"points are {count} numbers; must be 3 for each point")
    return pointer, count // 3, owner


def _flat(values):
    for one in values:
        if hasattr(one, "__iter__"):
            yield from _flat(one)
        else:
            yield float(one)


def _empty(shape, code):
    """A new array (pointer, owner) of doubles "d", floats "f" or bytes "B"."""
    if numpy is not None:
        own = numpy.empty(shape, {"d": numpy.float64, "f": numpy.float32, "B": numpy.uint8}[code])
        return own.ctypes.data, own
    count = 1
    for size in shape:
        count *= size
    own = array.array(code, bytes(count * array.array(code).itemsize))
    return own.buffer_info()[0], own


def _columns(structs, *names):
    """Members of an array of structs as arrays that share its memory (copies without NumPy)."""
    if numpy is not None:
        table = numpy.ctypeslib.as_array(structs)
        return [table[name] for name in names]
    return [[getattr(one, name) for one in structs] for name in names]


def data_directory():
    """The folder with the lenses and glasses of the library."""
    folder = _c.petzval_data_directory()
    if folder is None:
        raise Error(3, "the data of petzval were not found")
    return folder.decode()


class _Handle:
    def __init__(self):
        self._handle = ctypes.c_void_p()

    def __del__(self):
        if getattr(self, "_handle", None):
            self._free(self._handle)


class Glasses(_Handle):
    """The installed glasses, and those of a file (.agf, refractiveindex.info, CSV)."""
    _free = _c.petzval_glasses_free

    def __init__(self, file=None, base=None):
        super().__init__()
        _call("glasses_create", os.fsencode(file) if file else None, base._handle if base else None, ctypes.byref(self._handle))

    def __len__(self):
        return _c.petzval_glasses_count(self._handle)

    def __getitem__(self, index):
        if not 0 <= index < len(self):
            raise IndexError(index)
        glass = Glass()
        _call("glasses_get", self._handle, c_size(index), ctypes.byref(glass))
        return glass


class Lens(_Handle):
    """A lens from a file, or a shipped lens by its name. Changes return the lens, so that calls can be chained."""
    _free = _c.petzval_lens_free

    def __init__(self, file, wavelengths_nm=None, primary_nm=0, glasses=None, clamp=False, require_glasses=False, configuration=0, entry=None):
        super().__init__()
        if not os.path.exists(file) and os.path.dirname(file) == "" and not file.endswith(".json"):
            shipped = os.path.join(data_directory(), "lenses", file + ".json")
            file = shipped if os.path.exists(shipped) else file
        options = _LensOptions(primary_nm=primary_nm, clamp_wavelengths=clamp, require_glasses=require_glasses, configuration=configuration,
                               entry=entry.encode() if entry else None)
        if wavelengths_nm is not None:
            options.wavelengths_nm, options.wavelength_count, self._keep = _numbers(wavelengths_nm)
        if glasses is not None:
            options.glasses = glasses._handle
        _call("lens_read", os.fsencode(file), ctypes.byref(options), ctypes.byref(self._handle))

    def copy(self):
        other = Lens.__new__(Lens)
        _Handle.__init__(other)
        _call("lens_copy", self._handle, ctypes.byref(other._handle))
        return other

    def f_number(self, value):
        _call("lens_set_f_number", self._handle, c_double(value))
        return self

    def iris(self, blades, roundness=0, rotation_rad=0):
        _call("lens_set_iris", self._handle, c_int32(blades), c_double(roundness), c_double(rotation_rad))
        return self

    def focus(self, distance_mm, origin="front_vertex"):
        _call("lens_set_focus", self._handle, c_double(distance_mm), c_int32(_choice(ORIGINS, origin, "origin")))
        return self

    @property
    def info(self):
        info = LensInfo()
        _call("lens_get_info", self._handle, ctypes.byref(info))
        return info

    @property
    def surfaces(self):
        rows = [Surface() for _ in range(self.info.surface_count)]
        for index, row in enumerate(rows):
            _call("lens_get_surface", self._handle, c_size(index), ctypes.byref(row))
        return rows

    def _text(self, kind, index=0):
        length = c_size()
        _call("lens_get_text", self._handle, c_int32(kind), c_size(index), None, c_size(0), ctypes.byref(length))
        text = ctypes.create_string_buffer(length.value)
        _call("lens_get_text", self._handle, c_int32(kind), c_size(index), text, length, None)
        return text.value.decode()

    def _texts(self, kind):
        texts = []
        while text := self._text(kind, len(texts)):
            texts.append(text)
        return texts

    name = property(lambda self: self._text(0))
    warnings = property(lambda self: self._texts(1), doc="assumptions of the reader of the file")
    clamped_glasses = property(lambda self: self._texts(2))
    missing_glasses = property(lambda self: self._texts(3))
    prescription = property(lambda self: self._text(4), doc="the lens as JSON")

    def report(self, fields_deg=None, threads=0):
        """First-order data, pupils and aberrations as a dict, with the keys of lib/docs/reports.md (report).

        fields_deg: field angles; by default 0, 0.7 and 1 of the declared half field, or only 0.
        """
        if fields_deg is None:
            half = self.info.declared_half_field_deg
            fields_deg = [0, 0.7 * half, half] if half > 0 else [0]
        pointer, count, _keep = _numbers(fields_deg)
        text = ctypes.create_string_buffer(1 << 24)
        _call("lens_report", self._handle, ctypes.c_void_p(pointer), c_size(count), c_int32(threads), text, c_size(len(text)), None)
        return json.loads(text.value)

    def fit_film(self, points, film=None, max_tilt_rad=0):
        """Moves, and with max_tilt_rad also tilts, a film so that points are sharp.

        points: (x, y, z), (x, y, z, blur_mm) or (x, y, z, blur_mm, weight) each. Returns the film and a FilmFit.
        """
        film = Film.from_buffer_copy(film or Film())
        fit = FilmFit()
        rows = [tuple(p) + (0, 1)[len(p) - 3:] for p in points]
        targets = (_FocusPoint * len(rows))(*[_FocusPoint(position_mm=(c_double * 3)(*r[:3]), blur_mm=r[3], weight=r[4]) for r in rows])
        _call("lens_fit_film", self._handle, targets, c_size(len(rows)), c_double(max_tilt_rad), ctypes.byref(film), ctypes.byref(fit))
        return film, fit

    def choose_model(self, film=None, **requirements):
        """The cheapest ray model within limits: near_mm, far_mm, max_px, max_of_blur, exposure, pupil_shape, threads."""
        choice = Choice()
        _call("lens_choose_model", self._handle, ctypes.byref(film or Film()), ctypes.byref(_Requirements(**requirements)),
              ctypes.byref(choice))
        return choice


class Camera(_Handle):
    """A lens and a film, seen through a ray model. Options are those of petzval_camera_options."""
    _free = _c.petzval_camera_free

    def __init__(self, lens, film=None, model="exact_float", frame="lens", origin="front_vertex", normalisation="irradiance",
                 near_far_origin="front_vertex", **options):
        super().__init__()
        own = _CameraOptions(model=model.encode(), frame=_choice(FRAMES, frame, "frame"), origin=_choice(ORIGINS, origin, "origin"),
                             normalisation=_choice(NORMALISATIONS, normalisation, "normalisation"),
                             near_far_origin=_choice(ORIGINS, near_far_origin, "near_far_origin"), **options)
        _call("camera_create", lens._handle, ctypes.byref(film or Film()), ctypes.byref(own), ctypes.byref(self._handle))

    @classmethod
    def read(cls, setup):
        """The camera of bytes that write() returned."""
        camera = cls.__new__(cls)
        _Handle.__init__(camera)
        _call("camera_read", setup, c_size(len(setup)), ctypes.byref(camera._handle))
        return camera

    def write(self):
        length = c_size()
        _call("camera_write", self._handle, None, c_size(0), ctypes.byref(length))
        setup = ctypes.create_string_buffer(length.value)
        _call("camera_write", self._handle, setup, length, None)
        return setup.raw

    @property
    def info(self):
        info = CameraInfo()
        _call("camera_get_info", self._handle, ctypes.byref(info))
        return info

    def set_focus(self, opens_mm, closes_mm=None):
        """Changes the focus of a camera made with near_mm and far_mm."""
        _call("camera_set_focus", self._handle, c_double(opens_mm), c_double(opens_mm if closes_mm is None else closes_mm))

    def sample(self, raster_x, raster_y, pupil_u, pupil_v, wavelengths_nm=None, times=None):
        """Rays of N samples: a dictionary of arrays x, y, z, dx, dy, dz, weights, fates, pdf_pupil, pdf_direction."""
        inputs = [_numbers(values) for values in (raster_x, raster_y, pupil_u, pupil_v)]
        count = inputs[0][1]
        inputs.append(_numbers(wavelengths_nm, "f") if wavelengths_nm is not None else (None, count, None))
        inputs.append(_numbers(times) if times is not None else (None, count, None))
        if any(n != count for _, n, _ in inputs):
            raise Error(1, f"arrays of {sorted({n for _, n, _ in inputs})} numbers; must have the same length")
        names = [name for name, *_ in _Rays._fields_]
        outputs = {name: _empty((count,), "B" if name == "fates" else "d") for name in names}
        samples = _Samples(**{name: pointer for (name, *_), (pointer, *_) in zip(_Samples._fields_, inputs)})
        rays = _Rays(**{name: pointer for name, (pointer, _) in outputs.items()})
        _call("camera_sample_double", self._handle, c_size(count), ctypes.byref(samples), ctypes.byref(rays))
        return {name: owner for name, (_, owner) in outputs.items()}

    def connect(self, points, pupil_u, pupil_v, wavelengths_nm=None):
        """Connections from N points: a dictionary of direction, distance, on_front, pdf, we, raster_x, raster_y, fate."""
        at, count, _keep = _points(points)
        (u, _, _u), (v, _, _v) = _numbers(pupil_u), _numbers(pupil_v)
        nm, _, _nm = _numbers(wavelengths_nm, "f") if wavelengths_nm is not None else (None, 0, None)
        if any(n != count for n in (len(_u), len(_v))) or (_nm is not None and len(_nm) != count):
            raise Error(1, "points, pupil_u, pupil_v and wavelengths_nm; must have the same number of points")
        found = (_Connection * count)()
        pointers = [ctypes.c_void_p(p) for p in (at, u, v, nm)]
        _call("camera_connect", self._handle, c_size(count), *pointers, None, found)
        direction, distance, on_front, pdf, importance = _columns(found, "direction", "distance", "on_front", "pdf", "importance")
        if numpy is not None:
            inner = {name: importance[name] for name in ("we", "raster_x", "raster_y", "fate")}
        else:
            inner = {name: [getattr(one, name) for one in importance] for name in ("we", "raster_x", "raster_y", "fate")}
        return {"direction": direction, "distance": distance, "on_front": on_front, "pdf": pdf, **inner}

    def project(self, points, nm=0, time=0):
        """Raster positions of the chief rays of N points, [N, 2] (NaN: not seen), and N bytes: 1 if they pass."""
        at, count, _keep = _points(points)
        (raster, found), (visible, seen) = _empty((count, 2), "d"), _empty((count,), "B")
        _call("camera_project", self._handle, c_size(count), ctypes.c_void_p(at), c_double(nm), c_double(time),
              ctypes.c_void_p(raster), ctypes.c_void_p(visible))
        return found, seen

    def point_image(self, point, pixels=64, samples=0, half_width_mm=0, centre_mm=None, distant=False, seed=0, threads=1):
        """PSF of a point: a Psf and an image [wavelength, row, column]; distant: the direction towards the light."""
        options = _PsfOptions(samples=samples, pixels=pixels, half_width_mm=half_width_mm, distant=distant, seed=seed, threads=threads,
                              centre_mm=(c_double * 2)(*(centre_mm or (0, 0))), has_centre=centre_mm is not None)
        psf = Psf()
        at = (c_double * 3)(*point)
        wavelengths = self.info.wavelength_count
        data, image = _empty((wavelengths, pixels, pixels), "f")
        _call("camera_point_image", self._handle, at, ctypes.byref(options), ctypes.byref(psf), ctypes.c_void_p(data),
              c_size(wavelengths * pixels * pixels))
        return psf, image

    def spot(self, point, count=4096, nm=None):
        """Spot of a point: film positions x and y (mm) and weights of the rays that pass; the picture is upright."""
        golden = 0.6180339887498949
        u = [(i + 0.5) / count for i in range(count)]
        v = [(0.5 + i * golden) % 1 for i in range(count)]
        found = self.connect([tuple(point)] * count, u, v, [nm] * count if nm else None)
        info = self.info
        rows = [(x, y, w / p) for x, y, w, p in zip(found["raster_x"], found["raster_y"], found["we"], found["pdf"]) if w > 0]
        x = [(row[0] - info.columns / 2) * info.film_width_mm / info.columns for row in rows]
        y = [(info.rows / 2 - row[1]) * info.film_height_mm / info.rows for row in rows]
        weights = [row[2] for row in rows]
        return (numpy.array(x), numpy.array(y), numpy.array(weights)) if numpy is not None else (x, y, weights)


class LensRays(_Handle):
    """Rays of a camera through layers, count for each pixel; other options as in petzval_lens_rays_options."""
    _free = _c.petzval_lens_rays_free

    def __init__(self, camera, count=100, rgb_nm=None, **options):
        super().__init__()
        own = _RaysOptions(count=count, **options)
        if rgb_nm is not None:
            red, green, blue = rgb_nm
            own.rgb_nm, _, _keep = _numbers((red, green, blue))
        _call("lens_rays_create", camera._handle, ctypes.byref(own), ctypes.byref(self._handle))
        self.columns, self.rows = camera.info.columns, camera.info.rows

    def info(self, nearest_mm, farthest_mm):
        info = RaysInfo()
        _call("lens_rays_get_info", self._handle, c_double(nearest_mm), c_double(farthest_mm), ctypes.byref(info))
        return info


class Layers(_Handle):
    """A scene from images (rgba [rows, columns, 4], depth_mm [rows, columns]), from near to far."""
    _free = _c.petzval_layers_free

    def __init__(self, columns, rows, images):
        super().__init__()
        planes = [[_numbers(values, "f") for values in image] for image in images]
        if any([count for _, count, _ in image] != [4 * columns * rows, columns * rows] for image in planes):
            raise Error(1, f"images must have 4 and 1 numbers for each of {columns} x {rows} pixels")
        pointers = [(ctypes.c_void_p * len(planes))(*[image[i][0] for image in planes]) for i in (0, 1)]
        _call("layers_create", c_int32(columns), c_int32(rows), c_size(len(planes)), *pointers, ctypes.byref(self._handle))

    @classmethod
    def deep(cls, columns, rows, pixels, bias, most_layers):
        """From deep samples: for each pixel a list of (depth_mm, red, green, blue, alpha) in any order."""
        self = cls.__new__(cls)
        _Handle.__init__(self)
        if len(pixels) != columns * rows:
            raise Error(1, f"{len(pixels)} pixels; must be {columns} x {rows}")
        offsets = (c_size * (len(pixels) + 1))(0, *itertools.accumulate(map(len, pixels)))
        data, count, _keep = _numbers([number for pixel in pixels for sample in pixel for number in sample], "f")
        _call("layers_create_deep", c_int32(columns), c_int32(rows), offsets, ctypes.c_void_p(data), c_size(count // 5), c_double(bias),
              c_int32(most_layers), ctypes.byref(self._handle))
        return self


class Blur(_Handle):
    """Renders layers through lens rays; its memory is reused."""
    _free = _c.petzval_blur_free

    def __init__(self):
        super().__init__()
        _call("blur_create", ctypes.byref(self._handle))

    def gather(self, layers, rays, region=None, threads=0, highlights_above=1, progress=None):
        """The picture [rows, columns, 4], or its region (left, top, columns, rows). progress(done) returns True to cancel.

        Raises Error if cancelled, or what progress() raised.
        """
        left, top, columns, rows = region or (0, 0, rays.columns, rays.rows)
        own = _GatherOptions(threads=threads, left=left, top=top, columns=columns, rows=rows, highlights_above=highlights_above)
        raised = []

        def report(done, _):
            try:
                return bool(progress(done))
            except BaseException as error:
                raised.append(error)
                return True

        if progress:
            own.progress = _Progress(report)
        data, picture = _empty((max(rows, 0), max(columns, 0), 4), "f")
        try:
            _call("gather", layers._handle, rays._handle, ctypes.byref(own), self._handle, ctypes.c_void_p(data),
                  ctypes.c_ssize_t(16 * columns), None)
        except Error:
            if raised:
                raise raised[0] from None
            raise
        return picture
