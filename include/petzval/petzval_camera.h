/* SPDX-License-Identifier: Apache-2.0 */
/* A camera with a real lens in one file: C99, C++11, CUDA, OpenCL C, GLSL 4.50 and HLSL, without other headers.
 *
 * `petzval export LENS --camera camera.h` writes the table of a lens: surfaces, media, pupils, iris and film as one
 * array of floats. This file turns the table into rays. lib/docs/camera_table.md describes the table.
 *
 *     #include "petzval_camera.h"
 *     #include "camera.h"
 *     if (!pz_valid(petzval_table, sizeof petzval_table / sizeof *petzval_table)) return;  // once for each table
 *     pz_point film = pz_film_point(petzval_table, column, row);
 *     pz_ray ray = pz_sample(petzval_table, film.x, film.y, u, v, 587.56f);
 *     if (ray.fate == 0) colour += ray.weight * radiance(ray);
 *
 * gcc and clang need -fno-math-errno, which is also faster, or -lm. g++ with -march=native needs -mtune=generic: g++
 * 12, tuned for AMD Zen 3, takes 911 ns instead of 514 for a connection if one source also calls the other functions.
 *
 * In shaders the table is a buffer, not a parameter. Define PETZVAL_GLSL or PETZVAL_HLSL and PETZVAL_TABLE(i), element
 * i of the table, before this file, and leave out the first argument of all functions:
 *
 *     layout(std430, binding = 0) readonly buffer Camera { float camera_table[]; };
 *     #define PETZVAL_GLSL
 *     #define PETZVAL_TABLE(i) camera_table[i]
 *
 * Functions: pz_valid, pz_film_point, pz_raster, pz_sample, pz_sample_differential, pz_importance, pz_connect and
 * pz_pdf. Other functions are internal. Frame of the lens: z runs along the axis from the scene to the film; the vertex
 * of the first surface is at 0. Lengths are in mm, wavelengths in nm. Fates of rays: 0 transmitted, 1 missed a surface,
 * 2 total reflection, 3 clipped by an aperture, 5 outside the fit of a polynomial, 6 outside the film, 7 invalid, 8
 * outside the wavelengths of the table.
 *
 * Accuracy: as the float rays of the library; the distance to these rays is at most 8 float eps for most lenses of
 * data/ and up to 30 for fisheyes, whose float rays are up to 20 eps from exact rays
 * (tests/camera/camera_table_test.cpp).
 */
#ifndef PETZVAL_CAMERA_H
#define PETZVAL_CAMERA_H

/* ---- Languages ---- */

#if defined(PETZVAL_GLSL) || defined(PETZVAL_HLSL)
#define PZ_FN
#define PZ_T
#define PZ_P
#define PZ_AT(i) PETZVAL_TABLE(i)
#define PZ_STRUCT(name) struct name
#define PZ_BOOL bool
#define PZ_FLOAT(x) float(x)
#define PZ_INT(x) int(x)
#define PZ_SQRT(x) sqrt(x)
#else
#if defined(__CUDACC__)
#define PZ_FN static inline __host__ __device__
#else
#define PZ_FN static inline
#endif
#if defined(__OPENCL_VERSION__)
#define PZ_T __global const float *pz_t,
#else
#define PZ_T const float *pz_t,
#endif
#define PZ_P pz_t,
#define PZ_AT(i) pz_t[i]
#define PZ_STRUCT(name)     \
  typedef struct name name; \
  struct name
#if defined(__cplusplus)
#define PZ_BOOL bool
#define PZ_FLOAT(x) static_cast<float>(x)
#define PZ_INT(x) static_cast<int>(x)
#else
#define PZ_BOOL int
#define PZ_FLOAT(x) ((float)(x))
#define PZ_INT(x) ((int)(x))
#endif
#if defined(PETZVAL_SQRT) /* another square root */
#define PZ_SQRT(x) PETZVAL_SQRT(x)
#elif defined(__OPENCL_VERSION__)
#define PZ_SQRT(x) sqrt(x)
#elif defined(__GNUC__)
#define PZ_SQRT(x) __builtin_sqrtf(x)
#else
#define PZ_SQRT(x) sqrtf(x) /* include math.h before this file */
#endif
#endif
#define PZ_TRUE (1 == 1)
#define PZ_FALSE (1 == 0)

/* ---- Positions in the table ---- */

#define PZ_FORMAT 5 /* number at position 0 */
#define PZ_RAYS 2   /* 0: surfaces, 1: polynomial */
#define PZ_WAVELENGTH_COUNT 3
#define PZ_PRIMARY 4
#define PZ_WAVELENGTHS 5
#define PZ_SHORTEST 6
#define PZ_LONGEST 7
#define PZ_T_SCALE 8
#define PZ_T_OFFSET 9
#define PZ_NUMBER_COUNT 10
#define PZ_NUMBERS 11
#define PZ_POWERS 12
#define PZ_FILM_Z 13
#define PZ_PUPIL_Z 14
#define PZ_FILM_X 15
#define PZ_FILM_Y 16
#define PZ_FILM_WIDTH 17
#define PZ_FILM_HEIGHT 18
#define PZ_MARGIN 19
#define PZ_COLUMNS 20
#define PZ_ROWS 21
#define PZ_FRONT_Z 22
#define PZ_FRONT_CURVATURE 23
#define PZ_FRONT_FIRST 24
#define PZ_SURFACE_COUNT 25
#define PZ_SURFACES 26
#define PZ_MIRRORS 27
#define PZ_EDGES 28
#define PZ_BLADES 29
#define PZ_IRIS_AREA 30
#define PZ_IRIS 31
#define PZ_PUPIL_DIMENSIONS 32
#define PZ_REACH 33
#define PZ_PUPIL_ROWS 34
#define PZ_PUPIL_COLUMNS 35
#define PZ_ROWS_PER_MM 36
#define PZ_HALF_WIDTHS 37
#define PZ_CELLS 38
#define PZ_CELL_SIZE 39
#define PZ_OBSCURED 40
#define PZ_CORRECTIONS 41
#define PZ_STOPS 42
#define PZ_STOP_SIZE 43
#define PZ_TERMS 44
#define PZ_DEGREE 45
#define PZ_DOMAIN_FILM 46
#define PZ_DOMAIN_SHIFT_X 47
#define PZ_DOMAIN_RADIUS_X 48
#define PZ_DOMAIN_SHIFT_Y 49
#define PZ_DOMAIN_RADIUS_Y 50
#define PZ_REFERENCE_Z 51
#define PZ_SCENE_DIMENSIONS 52
#define PZ_CENTRE_Z 53
#define PZ_STEEPEST 54
#define PZ_FRONT_HALF 55
#define PZ_NODES 56
#define PZ_NODE_SIZE 57
#define PZ_WIDEST 58
#define PZ_BALLS 59
#define PZ_HEAD 60

#define PZ_SURFACE_SIZE 12
#define PZ_CORNERS 64

/* ---- Types ---- */

PZ_STRUCT(pz_point) { float x, y; };
PZ_STRUCT(pz_vector) { float x, y, z; };
/* A camera ray: origin on the front of the lens, unit direction into the scene. The mean of weight * radiance over
 * samples is the irradiance of the film divided by pi, or 1 on the axis, as the table was exported. */
PZ_STRUCT(pz_ray) {
  pz_vector origin, direction;
  float weight;    /* 0 if the ray is lost */
  float pdf_pupil; /* 1/mm^2 */
  int fate;
};
/* A camera ray with its derivatives by film x and y, per mm. */
PZ_STRUCT(pz_ray_differential) {
  pz_ray ray;
  pz_vector origin_by_x, direction_by_x, origin_by_y, direction_by_y;
};
/* A ray of the scene at the film; see Importance in the library. */
PZ_STRUCT(pz_arrival) {
  float we; /* importance, 1/mm^2; 0 if the ray is lost */
  pz_point film;
  float pdf_film, pdf_pupil, pdf_position, pdf_direction;
  int fate;
};
/* A connection from a scene point to the lens; see ImportanceSample in the library. */
PZ_STRUCT(pz_connection) {
  pz_vector direction; /* unit, from the point to the lens */
  float distance;      /* from the point to `end`, mm */
  pz_vector end;       /* of the shadow ray, on the front of the lens */
  float pdf;           /* 1/sr; 0 if there is no connection */
  pz_arrival arrival;
};

/* ---- Small functions ---- */

PZ_FN int pz_whole(PZ_T int at) { return PZ_INT(PZ_AT(at)); }
PZ_FN float pz_abs(float x) { return x < 0.0f ? -x : x; }
PZ_FN float pz_clamped(float x) { return x > 0.0f ? (x < 1.0f ? x : 1.0f) : 0.0f; }
PZ_FN PZ_BOOL pz_finite(float x) { return pz_abs(x) <= 3.0e38f; }
PZ_FN pz_point pz_xy(float x, float y) {
  pz_point p;
  p.x = x;
  p.y = y;
  return p;
}
PZ_FN pz_vector pz_xyz(float x, float y, float z) {
  pz_vector v;
  v.x = x;
  v.y = y;
  v.z = z;
  return v;
}
PZ_FN float pz_dot(pz_vector a, pz_vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
/* a + s b */
PZ_FN pz_vector pz_along(pz_vector a, float s, pz_vector b) {
  return pz_xyz(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

/* The fraction of a turn from +y towards +x of a direction, in [-1/2, 1/2], within 6e-8: asin(a) / 2 pi up to an eighth
 * of a turn by a polynomial of least maximum error, and symmetry. */
PZ_FN float pz_turn_of(float sine, float cosine) {
  float across = pz_abs(sine), along = pz_abs(cosine), a = along < across ? along : across, s = a * a, s2 = s * s;
  float first = 0.15915393812486814f + s * 0.0265771964583f, second = 0.0111934983367f + s * 0.0116048821993f;
  float third = -0.0077339762488f + s * 0.0181935231706f, turn = a * (first + s2 * (second + s2 * third));
  if (across > along) turn = 0.25f - turn;
  if (cosine < 0.0f) turn = 0.5f - turn;
  return sine < 0.0f ? -turn : turn;
}
/* The point of the unit circle at a fraction of a turn, by Taylor series in an eighth of a turn. */
PZ_FN pz_point pz_circle(float u) {
  float quarters = 4.0f * u, angle, s, sine, cosine;
  int quarter = PZ_INT(quarters + 0.5f);
  angle = 1.57079632679f * (quarters - PZ_FLOAT(quarter));
  s = angle * angle;
  sine = angle * (1.0f - s / 6.0f * (1.0f - s / 20.0f * (1.0f - s / 42.0f * (1.0f - s / 72.0f))));
  cosine = 1.0f - s / 2.0f * (1.0f - s / 12.0f * (1.0f - s / 30.0f * (1.0f - s / 56.0f * (1.0f - s / 90.0f))));
  quarter = quarter - 4 * (quarter / 4);
  if (quarter == 0) return pz_xy(sine, cosine);
  if (quarter == 1) return pz_xy(cosine, -sine);
  if (quarter == 2) return pz_xy(-sine, -cosine);
  return pz_xy(-cosine, sine);
}
PZ_FN float pz_fraction(float x) { /* the fractional part, for x from -1 to 2 */
  float from_0 = x < 0.0f ? x + 1.0f : x;
  return from_0 > 1.0f ? from_0 - 1.0f : from_0;
}

/* ---- Film ---- */

/* Raster (0, 0) is the upper left corner of the upright picture. */
PZ_FN pz_point pz_film_point(PZ_T float column, float row) {
  return pz_xy((0.5f - column / PZ_AT(PZ_COLUMNS)) * PZ_AT(PZ_FILM_WIDTH) + PZ_AT(PZ_FILM_X),
               (row / PZ_AT(PZ_ROWS) - 0.5f) * PZ_AT(PZ_FILM_HEIGHT) + PZ_AT(PZ_FILM_Y));
}
PZ_FN pz_point pz_raster(PZ_T pz_point film) {
  return pz_xy((0.5f - (film.x - PZ_AT(PZ_FILM_X)) / PZ_AT(PZ_FILM_WIDTH)) * PZ_AT(PZ_COLUMNS),
               (0.5f + (film.y - PZ_AT(PZ_FILM_Y)) / PZ_AT(PZ_FILM_HEIGHT)) * PZ_AT(PZ_ROWS));
}
PZ_FN PZ_BOOL pz_on_film(PZ_T float x, float y) {
  float half_width = 0.5f * PZ_AT(PZ_FILM_WIDTH) + PZ_AT(PZ_MARGIN);
  float half_height = 0.5f * PZ_AT(PZ_FILM_HEIGHT) + PZ_AT(PZ_MARGIN);
  return pz_abs(x - PZ_AT(PZ_FILM_X)) <= half_width * 1.000001f &&
         pz_abs(y - PZ_AT(PZ_FILM_Y)) <= half_height * 1.000001f;
}

/* ---- Wavelengths ---- */

/* A wavelength in the table. */
PZ_STRUCT(pz_light) {
  int nearest;      /* position of the nearest compiled wavelength; -1: outside the wavelengths of the table */
  PZ_BOOL compiled; /* within 0.005 nm of the nearest one */
  float t;          /* coordinate from -1 to 1, linear in 1 / nm */
};
PZ_FN pz_light pz_light_of(PZ_T float nm) {
  pz_light found;
  float least = 3.0e38f, t = PZ_AT(PZ_T_SCALE) / nm - PZ_AT(PZ_T_OFFSET);
  int count = pz_whole(PZ_P PZ_WAVELENGTH_COUNT), list = pz_whole(PZ_P PZ_WAVELENGTHS);
  found.nearest = -1;
  for (int w = 0; w < count; ++w) {
    float away = pz_abs(nm - PZ_AT(list + w));
    if (away < least) {
      least = away;
      found.nearest = w;
    }
  }
  found.compiled = least <= 0.005f;
  if (!found.compiled && !(nm >= PZ_AT(PZ_SHORTEST) && nm <= PZ_AT(PZ_LONGEST))) {
    found.nearest = -1;
  }
  found.t = t < 1.0f ? (t > -1.0f ? t : -1.0f) : 1.0f;
  return found;
}
/* A number that depends on the wavelength: 0 scale of weights, 1 importance, 2 density of film samples, 3 area of the
 * entrance pupil, then the squared index of each space, then its change at each surface. */
PZ_FN float pz_number(PZ_T pz_light light, int k) {
  if (light.compiled) {
    return PZ_AT(pz_whole(PZ_P PZ_NUMBERS) + light.nearest * pz_whole(PZ_P PZ_NUMBER_COUNT) + k);
  } else {
    int at = pz_whole(PZ_P PZ_POWERS) + 8 * k;
    float sum = 0.0f;
    for (int i = 7; i >= 0; --i) sum = sum * light.t + PZ_AT(at + i);
    return sum;
  }
}

/* ---- Check of a table ---- */

/* The whole number from 0 to most at a position; -1: there is another number. */
PZ_FN int pz_count(PZ_T int at, int most) {
  float x = PZ_AT(at);
  int n = x >= 0.0f && x <= PZ_FLOAT(most) ? PZ_INT(x) : -1;
  return PZ_FLOAT(n) == x ? n : -1;
}
/* a b, or most + 1 if this is more; a and b are from 0 to most + 1. */
PZ_FN int pz_product(int a, int b, int most) { return b == 0 || a <= most / b ? a * b : most + 1; }
/* True if the table has n numbers from the position on that is stored at `at`. */
PZ_FN PZ_BOOL pz_has(PZ_T int at, int n, int floats) {
  int begin = pz_count(PZ_P at, floats);
  return begin >= PZ_HEAD && n <= floats - begin;
}
/* True if `floats` numbers are a complete table of this format: no function reads outside of such a table. All other
 * functions trust their table: call this one first, for each table from a file. */
PZ_FN PZ_BOOL pz_valid(PZ_T int floats) {
  if (floats < PZ_HEAD || floats > 16777216 || PZ_AT(0) != PZ_FLOAT(PZ_FORMAT) || PZ_AT(1) != PZ_FLOAT(floats)) {
    return PZ_FALSE;
  }
  int w = pz_count(PZ_P PZ_WAVELENGTH_COUNT, floats), surfaces = pz_count(PZ_P PZ_SURFACE_COUNT, floats);
  int blades = pz_count(PZ_P PZ_BLADES, floats), stop_size = pz_count(PZ_P PZ_STOP_SIZE, floats);
  int rows = pz_count(PZ_P PZ_PUPIL_ROWS, floats), columns = pz_count(PZ_P PZ_PUPIL_COLUMNS, floats);
  int numbers = pz_count(PZ_P PZ_NUMBER_COUNT, floats), node_size = pz_count(PZ_P PZ_NODE_SIZE, floats), cells;
  int cell_size = pz_count(PZ_P PZ_CELL_SIZE, floats), list, count;
  float pupils = PZ_AT(PZ_PUPIL_DIMENSIONS), scene = PZ_AT(PZ_SCENE_DIMENSIONS), rays = PZ_AT(PZ_RAYS), widest = 0.0f;
  PZ_BOOL two = pupils == 2.0f;
  if (w < 1 || surfaces < 1 || blades < 0 || stop_size < 0 || rows < 1 || columns < 1 || numbers != 5 + 2 * surfaces ||
      pz_count(PZ_P PZ_PRIMARY, w - 1) < 0 || pz_count(PZ_P PZ_MIRRORS, surfaces) < 0 ||
      pz_count(PZ_P PZ_CORRECTIONS, floats) < 0 || (pupils != 1.0f && !two) || (scene != 2.0f && scene != 3.0f) ||
      (rays != 0.0f && rays != 1.0f)) {
    return PZ_FALSE;
  }
  /* Wavelengths. Numbers between the compiled ones are needed if a sample can have such a wavelength. */
  if (!pz_has(PZ_P PZ_WAVELENGTHS, w, floats) || !pz_has(PZ_P PZ_NUMBERS, pz_product(w, numbers, floats), floats)) {
    return PZ_FALSE;
  }
  pz_light end = pz_light_of(PZ_P PZ_AT(PZ_SHORTEST));
  if ((PZ_AT(PZ_SHORTEST) < PZ_AT(PZ_LONGEST) || (end.nearest >= 0 && !end.compiled)) &&
      !pz_has(PZ_P PZ_POWERS, pz_product(numbers, 8, floats), floats)) {
    return PZ_FALSE;
  }
  /* Surfaces and iris. */
  if (!pz_has(PZ_P PZ_SURFACES, pz_product(surfaces, PZ_SURFACE_SIZE, floats), floats) ||
      !pz_has(PZ_P PZ_EDGES, pz_product(blades, 4, floats), floats)) {
    return PZ_FALSE;
  }
  for (int i = 0; i < surfaces; ++i) {
    int at = pz_whole(PZ_P PZ_SURFACES) + i * PZ_SURFACE_SIZE + 10;
    list = pz_count(PZ_P at, floats);
    if (list == 0) continue;
    if (!pz_has(PZ_P at, 4, floats)) return PZ_FALSE;
    int even = pz_count(PZ_P list + 2, floats), odd = pz_count(PZ_P list + 3, floats);
    if (even < 0 || odd < 0 || !pz_has(PZ_P at, 4 + even + odd, floats)) return PZ_FALSE;
  }
  /* Pupils of film points: the row of each film point within reach is a whole number. */
  cells = pz_product(pz_product(w, rows, floats), two ? columns : 1, floats);
  if (cell_size < (two                          ? 1122
                   : PZ_AT(PZ_OBSCURED) != 0.0f ? 784
                                                : 528) ||
      !pz_has(PZ_P PZ_CELLS, pz_product(cells, cell_size, floats), floats) ||
      (two && !pz_has(PZ_P PZ_HALF_WIDTHS, rows + 1, floats)) || !(PZ_AT(PZ_ROWS_PER_MM) >= 0.0f) ||
      !(PZ_AT(PZ_REACH) >= 0.0f && PZ_AT(PZ_REACH) <= 1.0e15f && PZ_AT(PZ_REACH) * PZ_AT(PZ_ROWS_PER_MM) <= 1.0e9f)) {
    return PZ_FALSE;
  }
  if (stop_size != 0 && (blades < 1 || stop_size < (two ? 610 : 296) ||
                         !pz_has(PZ_P PZ_STOPS, pz_product(cells, stop_size, floats), floats) ||
                         !pz_has(PZ_P PZ_IRIS, 16 + pz_product(blades, 6, floats), floats))) {
    return PZ_FALSE;
  }
  if (rays == 1.0f) {
    int degree = pz_count(PZ_P PZ_DEGREE, 99), n = (degree - 1) / 2, terms = (n + 1) * (n + 2) * (n + 3) / 6;
    terms = two ? 4 * (n + 2) * terms : 4 * terms; /* two: 8 (n + 1) (n + 2)^2 (n + 3) / 12 */
    if (degree < 1 || !pz_has(PZ_P PZ_TERMS, pz_product(w, terms, floats), floats)) return PZ_FALSE;
  }
  /* Pupils of scene points: without nodes, all last fields are 0. */
  count = pz_product(w, scene == 3.0f ? 6 : 3, floats);
  if (!pz_has(PZ_P PZ_WIDEST, count, floats) || !pz_has(PZ_P PZ_BALLS, w, floats)) return PZ_FALSE;
  list = pz_whole(PZ_P PZ_WIDEST);
  for (int i = 0; i < count; ++i) {
    if (!(PZ_AT(list + i) >= 0.0f)) return PZ_FALSE;
    widest += PZ_AT(list + i);
  }
  count = pz_product(w, scene == 3.0f ? 147 : 39, floats);
  count = widest == 0.0f ? 0 : pz_product(count, node_size, floats);
  return (node_size == 132 || node_size == 260) && pz_has(PZ_P PZ_NODES, count, floats);
}

/* ---- Iris ---- */

/* Point (u, v) of an iris with blades, in semi-diameters of the stop: u counts sectors from the first corner, and v is
 * the fraction of the area nearer to the centre. */
PZ_FN pz_point pz_iris_point(PZ_T float u, float v) {
  int blades = pz_whole(PZ_P PZ_BLADES), list = pz_whole(PZ_P PZ_IRIS);
  float at = u * PZ_FLOAT(blades), q, t, across = 0.0f, along = 0.0f, radius = PZ_SQRT(v), sine, cosine;
  int k = PZ_INT(at) < blades - 1 ? PZ_INT(at) : blades - 1;
  q = 2.0f * (at - PZ_FLOAT(k)) - 1.0f;
  t = 2.0f * q * q - 1.0f;
  for (int i = 7; i >= 0; --i) {
    across = across * t + PZ_AT(list + i);
    along = along * t + PZ_AT(list + 8 + i);
  }
  across *= q;
  sine = PZ_AT(list + 16 + 2 * k);
  cosine = PZ_AT(list + 17 + 2 * k);
  return pz_xy(radius * (along * sine + across * cosine), radius * (along * cosine - across * sine));
}
/* Distance of a point inside edge k of the iris. list: edges in mm or in semi-diameters. */
PZ_FN float pz_inside(PZ_T int list, int k, float x, float y) {
  int edge = list + 4 * k;
  return PZ_AT(edge + 3) - (x * PZ_AT(edge) + y * PZ_AT(edge + 1) + PZ_AT(edge + 2) * (x * x + y * y));
}
PZ_FN int pz_unit_edges(PZ_T int blades) { return pz_whole(PZ_P PZ_IRIS) + 16 + 2 * blades; }

/* ---- Pupils of film points ---- */

/* A pupil is a polygon with a middle and 64 corners around it, in order from +y towards +x. Sector k is the triangle
 * between the middle and corners k and k + 1; an interval of its squared relative radii may be obscured. */
PZ_STRUCT(pz_sector) {
  pz_point a, b; /* the corners, relative to the middle */
  float dark_from, dark;
};
/* Twice the area of the triangle from the middle to a and b. */
PZ_FN float pz_turn(pz_point a, pz_point b) { return b.x * a.y - a.x * b.y; }
PZ_FN float pz_squared_radius(pz_sector s, float v) {
  float within = (1.0f - s.dark) * v;
  return within < s.dark_from ? within : within + s.dark;
}
/* Inverse of pz_squared_radius(). */
PZ_FN float pz_fraction_within(pz_sector s, float squared) {
  float past = squared - s.dark > s.dark_from ? squared - s.dark : s.dark_from, left = 1.0f - s.dark;
  return (squared < s.dark_from ? squared : past) / (left > 0.0f ? left : 1.0f);
}
/* The squared relative radius of a point in the direction of a sector: 0 in the middle, 1 at the edge; -1: the point
 * lies in another direction. */
PZ_FN float pz_squared_at(pz_sector s, pz_point q) {
  float behind = pz_turn(s.a, q), before = pz_turn(q, s.b), whole = pz_turn(s.a, s.b);
  float radius = (behind + before) / (whole > 0.0f ? whole : 1.0f);
  return behind >= 0.0f && before >= 0.0f && whole > 0.0f ? radius * radius : -1.0f;
}
PZ_FN PZ_BOOL pz_is_dark(pz_sector s, float squared) {
  return squared >= s.dark_from && squared < s.dark_from + s.dark;
}
/* True if a corner comes before the direction of q in the order of corners, which begins at the first corner. */
PZ_FN PZ_BOOL pz_comes_before(pz_point first, pz_point corner, pz_point q) {
  PZ_BOOL half_q = pz_turn(first, q) < 0.0f, half_corner = pz_turn(first, corner) < 0.0f;
  return half_corner == half_q ? pz_turn(corner, q) >= 0.0f : !half_corner;
}
/* The point of the outer edge at a fraction from a to b. */
PZ_FN pz_point pz_on_edge(pz_sector s, float along) {
  return pz_xy(s.a.x + along * (s.b.x - s.a.x), s.a.y + along * (s.b.y - s.a.y));
}

/* The place of a film point in the grid of pupils. One dimension: rows over the distance from the axis, with polygons
 * that turn with the film point. Two dimensions: cells of the quadrant x, y >= 0, with mirror images for the others. */
PZ_STRUCT(pz_cell) {
  PZ_BOOL known;
  PZ_BOOL two;     /* two dimensions */
  int cell, begin; /* begin: position of its numbers in the table */
  float t, s, sine, cosine;
};
PZ_FN pz_cell pz_find_cell(PZ_T float x, float y, int w) {
  pz_cell found;
  float reach = PZ_AT(PZ_REACH), r2 = x * x + y * y, rows_per_mm = PZ_AT(PZ_ROWS_PER_MM);
  int rows = pz_whole(PZ_P PZ_PUPIL_ROWS), columns = pz_whole(PZ_P PZ_PUPIL_COLUMNS);
  found.two = PZ_AT(PZ_PUPIL_DIMENSIONS) == 2.0f;
  found.s = 0.0f;
  if (!found.two) {
    float r = PZ_SQRT(r2), position;
    PZ_BOOL off_axis = r2 > 1.0e-31f;
    found.known = r <= reach;
    position = found.known ? r * rows_per_mm : 0.0f;
    int i = PZ_INT(position) < rows - 1 ? PZ_INT(position) : rows - 1;
    found.t = position - PZ_FLOAT(i);
    found.sine = off_axis ? x / r : 0.0f;
    found.cosine = off_axis ? y / r : 1.0f;
    found.cell = i + w * rows;
  } else {
    float row = pz_abs(y) * rows_per_mm, width, column;
    int i, j, widths = pz_whole(PZ_P PZ_HALF_WIDTHS);
    found.known = r2 <= reach * reach && row <= 1.000001f * PZ_FLOAT(rows);
    row = found.known ? row : 0.0f;
    i = PZ_INT(row) < rows - 1 ? PZ_INT(row) : rows - 1;
    found.s = row - PZ_FLOAT(i);
    width = PZ_AT(widths + i) + found.s * (PZ_AT(widths + i + 1) - PZ_AT(widths + i));
    found.known = found.known && pz_abs(x) <= 1.000001f * width;
    column = found.known ? pz_abs(x) / (width > 0.0f ? width : 1.0f) * PZ_FLOAT(columns) : 0.0f;
    j = PZ_INT(column) < columns - 1 ? PZ_INT(column) : columns - 1;
    found.t = column - PZ_FLOAT(j);
    found.sine = x < 0.0f ? -1.0f : 1.0f;
    found.cosine = y < 0.0f ? -1.0f : 1.0f;
    found.cell = (w * rows + i) * columns + j;
  }
  found.begin = pz_whole(PZ_P PZ_CELLS) + found.cell * pz_whole(PZ_P PZ_CELL_SIZE);
  return found;
}
/* A point in the frame of the film from the frame of the grid, and back. */
PZ_FN pz_point pz_to_film(pz_cell c, pz_point p) {
  if (c.two) return pz_xy(c.sine * p.x, c.cosine * p.y);
  return pz_xy(c.cosine * p.x + c.sine * p.y, c.cosine * p.y - c.sine * p.x);
}
PZ_FN pz_point pz_to_grid(pz_cell c, pz_point p) {
  if (c.two) return pz_xy(c.sine * p.x, c.cosine * p.y);
  return pz_xy(c.cosine * p.x - c.sine * p.y, c.sine * p.x + c.cosine * p.y);
}
/* A value of the cell: coefficients of 1, t, or of 1, t, s, s t. */
PZ_FN float pz_value(PZ_T pz_cell c, int at) {
  float along = PZ_AT(at) + c.t * PZ_AT(at + 1);
  return c.two ? along + c.s * (PZ_AT(at + 2) + c.t * PZ_AT(at + 3)) : along;
}
PZ_FN pz_point pz_values(PZ_T pz_cell c, int at) {
  return pz_xy(pz_value(PZ_P c, at), pz_value(PZ_P c, at + (c.two ? 4 : 2)));
}
/* An area of the cell: coefficients of 1, t, t^2, t^3, or of 1, t, t^2, s, s t, s t^2, s^2, s^2 t, s^2 t^2. */
PZ_FN float pz_cell_area(PZ_T pz_cell c, int at) {
  float t = c.t, one = PZ_AT(at) + t * (PZ_AT(at + 1) + t * PZ_AT(at + 2)), by_s, by_s2;
  if (!c.two) return one + t * t * t * PZ_AT(at + 3);
  by_s = PZ_AT(at + 3) + t * (PZ_AT(at + 4) + t * PZ_AT(at + 5));
  by_s2 = PZ_AT(at + 6) + t * (PZ_AT(at + 7) + t * PZ_AT(at + 8));
  return one + c.s * (by_s + c.s * by_s2);
}
PZ_FN int pz_corner_at(pz_cell c, int k) { return c.begin + (c.two ? 17 + 17 * k : 8 + 8 * k); }
PZ_FN pz_point pz_corner(PZ_T pz_cell c, int k) { return pz_values(PZ_P c, pz_corner_at(c, k)); }
PZ_FN pz_point pz_middle(PZ_T pz_cell c) {
  if (c.two) return pz_values(PZ_P c, c.begin);
  return pz_xy(0.0f, pz_value(PZ_P c, c.begin + 2));
}
PZ_FN float pz_area_before(PZ_T pz_cell c, int k) { return pz_cell_area(PZ_P c, pz_corner_at(c, k) + (c.two ? 8 : 4)); }
PZ_FN float pz_whole_area(PZ_T pz_cell c) { return pz_cell_area(PZ_P c, c.begin + (c.two ? 8 : 4)); }
PZ_FN pz_sector pz_sector_of(PZ_T pz_cell c, int k) {
  pz_sector s;
  s.a = pz_corner(PZ_P c, k);
  s.b = pz_corner(PZ_P c, k + 1);
  s.dark_from = 0.0f;
  s.dark = 0.0f;
  if (!c.two && PZ_AT(PZ_OBSCURED) != 0.0f) {
    pz_point dark = pz_values(PZ_P c, c.begin + 528 + 4 * k);
    s.dark_from = dark.x;
    s.dark = dark.y;
  }
  return s;
}

/* The image of a stop point in the pupil plane, in the frame of the grid, with derivatives by the stop point. */
PZ_STRUCT(pz_seen) { pz_point at, by_x, by_y; };
PZ_FN int pz_stop_at(PZ_T pz_cell c) { return pz_whole(PZ_P PZ_STOPS) + c.cell * pz_whole(PZ_P PZ_STOP_SIZE); }
PZ_FN pz_seen pz_see(PZ_T pz_cell c, pz_point stop) {
  pz_seen seen;
  float a[20], x = stop.x, y = stop.y, xx = x * x, yy = y * y;
  int begin = pz_stop_at(PZ_P c) + 2, step = c.two ? 4 : 2, count = c.two ? 20 : 15;
  for (int k = 0; k < count; ++k) a[k] = pz_value(PZ_P c, begin + step * k);
  if (!c.two) {
    float r = xx + yy, r2 = r * r, across = a[9] + y * (a[10] + a[13] * r) + a[11] * xx + a[12] * yy + a[14] * r2;
    float by_x = 2.0f * x * (a[11] + a[13] * y + 2.0f * a[14] * r);
    float by_y = a[10] + 2.0f * a[12] * y + a[13] * (r + 2.0f * yy) + 4.0f * a[14] * r * y;
    seen.at.x = x * across;
    seen.at.y =
        a[0] + y * (a[1] + a[3] * y + a[4] * xx + a[5] * yy + a[8] * r2) + a[2] * xx + a[6] * r2 + a[7] * r * yy;
    seen.by_x.x = across + x * by_x;
    seen.by_x.y = 2.0f * x * (a[2] + a[4] * y + 2.0f * a[6] * r + a[7] * yy + 2.0f * a[8] * y * r);
    seen.by_y.x = x * by_y;
    seen.by_y.y = a[1] + 2.0f * y * (a[3] + 2.0f * a[6] * r + a[7] * (r + yy)) + a[4] * xx + 3.0f * a[5] * yy +
                  a[8] * (r2 + 4.0f * yy * r);
    return seen;
  }
  for (int o = 0; o < 20; o += 10) {
    float value = a[o] + x * (a[o + 1] + a[o + 3] * x + a[o + 4] * y + a[o + 6] * xx + a[o + 8] * yy) +
                  y * (a[o + 2] + a[o + 5] * y + a[o + 7] * xx + a[o + 9] * yy);
    float by_x =
        a[o + 1] + 2.0f * a[o + 3] * x + a[o + 4] * y + 3.0f * a[o + 6] * xx + 2.0f * a[o + 7] * x * y + a[o + 8] * yy;
    float by_y =
        a[o + 2] + a[o + 4] * x + 2.0f * a[o + 5] * y + a[o + 7] * xx + 2.0f * a[o + 8] * x * y + 3.0f * a[o + 9] * yy;
    if (o == 0) {
      seen.at.x = value;
      seen.by_x.x = by_x;
      seen.by_y.x = by_y;
    } else {
      seen.at.y = value;
      seen.by_x.y = by_x;
      seen.by_y.y = by_y;
    }
  }
  return seen;
}
PZ_FN float pz_determinant(pz_seen s) { return s.by_x.x * s.by_y.y - s.by_y.x * s.by_x.y; }
/* A step of Newton's method towards the stop point whose image is p. */
PZ_FN pz_point pz_newton_step(pz_seen s, pz_point p) {
  float per = 1.0f / pz_determinant(s), x = p.x - s.at.x, y = p.y - s.at.y;
  return pz_xy((s.by_y.y * x - s.by_y.x * y) * per, (s.by_x.x * y - s.by_x.y * x) * per);
}

/* The interval of a line from a (0) to a + d (1) inside all edges of the iris, as from = x, to = y. */
PZ_FN pz_point pz_cut(PZ_T pz_point a, pz_point d) {
  int blades = pz_whole(PZ_P PZ_BLADES), list = pz_unit_edges(PZ_P blades);
  float from = 0.0f, to = 1.0f;
  for (int k = 0; k < blades; ++k) {
    float nx = PZ_AT(list + 4 * k), ny = PZ_AT(list + 4 * k + 1), bend = PZ_AT(list + 4 * k + 2);
    float outside = -pz_inside(PZ_P list, k, a.x, a.y), first, last = 2.0f, beyond = 2.0f;
    float slope = nx * d.x + ny * d.y + 2.0f * bend * (a.x * d.x + a.y * d.y), square = bend * (d.x * d.x + d.y * d.y);
    if (bend == 0.0f) {
      if (slope > 0.0f) last = -outside / slope;
      if (slope < 0.0f) beyond = -outside / slope;
    } else {
      float inner = slope * slope - 4.0f * square * outside;
      float root = PZ_SQRT(inner > 0.0f ? inner : 0.0f), entering = root - slope;
      if (inner >= 0.0f && -2.0f * outside / (slope + root) > 0.0f) last = -2.0f * outside / (slope + root);
      if (inner >= 0.0f && entering > 0.0f) beyond = 2.0f * outside / entering;
    }
    first = outside > 0.0f ? beyond : 0.0f;
    to = last < to ? last : to;
    from = first > from ? first : from;
  }
  return pz_xy(from, to);
}
/* Clips the line from the middle of a pupil to a point of its edge by the iris. The line is straight in the pupil and
 * nearly straight at the stop: a second pass corrects it at the clipped end. */
PZ_FN pz_point pz_clip(PZ_T pz_cell c, int k, float along, pz_point edge) {
  int stop = pz_stop_at(PZ_P c), corners = c.two ? 90 : 36, step = c.two ? 8 : 4;
  float scale = PZ_AT(stop + 1), look;
  pz_point middle = pz_values(PZ_P c, stop + corners - step), a = pz_values(PZ_P c, stop + corners + step * k);
  pz_point b = pz_values(PZ_P c, stop + corners + step * (k + 1));
  pz_point begin = pz_to_film(c, middle), path, interval, straight, in_pupil, off;
  path = pz_to_film(c, pz_xy(a.x + along * (b.x - a.x) - middle.x, a.y + along * (b.y - a.y) - middle.y));
  begin = pz_xy(begin.x / scale, begin.y / scale);
  path = pz_xy(path.x / scale, path.y / scale);
  interval = pz_cut(PZ_P begin, path);
  look = interval.y > 0.25f ? interval.y : 0.25f;
  straight = pz_to_grid(c, pz_xy(scale * (begin.x + look * path.x), scale * (begin.y + look * path.y)));
  middle = pz_middle(PZ_P c);
  in_pupil = pz_xy(middle.x + look * edge.x, middle.y + look * edge.y);
  off = pz_to_film(c, pz_newton_step(pz_see(PZ_P c, straight), in_pupil));
  path = pz_xy(path.x + off.x / (scale * look), path.y + off.y / (scale * look));
  interval = pz_cut(PZ_P begin, path);
  if (interval.x > interval.y) interval.x = interval.y;
  return interval;
}

/* A sample of a pupil: position in the pupil plane and area; area 0: there is no pupil. */
PZ_STRUCT(pz_pupil_sample) {
  pz_point at;
  float area;
};
PZ_FN pz_pupil_sample pz_sample_pupil(PZ_T pz_cell c, float u, float v) {
  pz_pupil_sample result;
  PZ_BOOL bladed = PZ_AT(PZ_STOP_SIZE) != 0.0f;
  int corrections = pz_whole(PZ_P PZ_CORRECTIONS), k;
  float area, target, expected, behind, beyond, own_area, along, radius, fraction = 1.0f;
  result.at = pz_xy(0.0f, 0.0f);
  result.area = 0.0f;
  if (!c.known) return result;
  u = pz_clamped(u);
  v = pz_clamped(v);
  if (bladed) {
    int stop = pz_stop_at(PZ_P c);
    if (PZ_AT(stop) > 0.0f) { /* uniform points of the iris */
      float scale = PZ_AT(stop + 1);
      pz_point p = pz_iris_point(PZ_P u, v);
      pz_seen seen = pz_see(PZ_P c, pz_to_grid(c, pz_xy(scale * p.x, scale * p.y)));
      result.at = pz_to_film(c, seen.at);
      result.area = PZ_AT(PZ_IRIS_AREA) * scale * scale * pz_abs(pz_determinant(seen));
      return result;
    }
  }
  area = pz_whole_area(PZ_P c);
  if (!(area > 0.0f)) return result;
  /* u starts at +y of the film; corners start at +y of the grid. */
  if (!c.two) {
    target = pz_clamped(pz_fraction(u - pz_turn_of(c.sine, c.cosine)));
    expected = target * 64.0f;
  } else {
    float right = pz_area_before(PZ_P c, 32) / area;
    float in_left, first, own_half, across = (1.0f - c.sine) / 2.0f + c.sine * u;
    target = pz_clamped(pz_fraction((1.0f - c.cosine) / 2.0f * right + c.cosine * across));
    in_left = target < right ? 0.0f : 1.0f;
    first = in_left * right;
    own_half = right + in_left * (1.0f - 2.0f * right);
    expected = 32.0f * (in_left + (target - first) / (own_half > 0.0f ? own_half : 1.0f));
  }
  /* Sectors have nearly equal areas: the target lies in the expected sector or in a neighbour. */
  expected -= corrections > 0 ? 0.0f : 0.5f;
  expected = expected > 0.0f ? (expected < 63.0f ? expected : 63.0f) : 0.0f;
  k = PZ_INT(expected);
  target *= area;
  for (int i = 0; i < corrections; ++i) {
    PZ_BOOL back = target < pz_area_before(PZ_P c, k) && k > 0;
    PZ_BOOL on = target > pz_area_before(PZ_P c, k + 1) && k < 63;
    if (!back && !on) break;
    k += back ? -1 : 1;
  }
  behind = target - pz_area_before(PZ_P c, k + 1);
  beyond = 1.0f;
  if (behind >= 0.0f && k < 63) {
    k += 1;
    beyond = 0.0f;
  }
  pz_sector own = pz_sector_of(PZ_P c, k);
  own_area = 0.5f * pz_turn(own.a, own.b) * (1.0f - own.dark);
  along = pz_clamped(behind / (own_area > 0.0f ? own_area : 1.0f) + beyond);
  pz_point edge = pz_on_edge(own, along);
  if (bladed) {
    pz_point interval = pz_clip(PZ_P c, k, along, edge);
    float first = pz_fraction_within(own, interval.x * interval.x);
    fraction = pz_fraction_within(own, interval.y * interval.y) - first;
    radius = PZ_SQRT(pz_squared_radius(own, first + v * fraction));
  } else {
    radius = PZ_SQRT(pz_squared_radius(own, v));
  }
  pz_point middle = pz_middle(PZ_P c);
  result.at = pz_to_film(c, pz_xy(middle.x + radius * edge.x, middle.y + radius * edge.y));
  result.area = area * fraction;
  return result;
}
/* The area that the sample at a point of the pupil plane represents; 0: no sample has this position. */
PZ_FN float pz_area_at(PZ_T pz_cell c, float x, float y) {
  PZ_BOOL bladed = PZ_AT(PZ_STOP_SIZE) != 0.0f;
  pz_point q, middle = pz_middle(PZ_P c), interval = pz_xy(0.0f, 1.0f);
  int k = 0;
  if (!c.known) return 0.0f;
  q = pz_to_grid(c, pz_xy(x, y));
  if (bladed && PZ_AT(pz_stop_at(PZ_P c)) > 0.0f) {
    float scale = PZ_AT(pz_stop_at(PZ_P c) + 1), step2 = 0.0f, area;
    int blades = pz_whole(PZ_P PZ_BLADES);
    pz_point stop = pz_xy(0.0f, 0.0f);
    for (int i = 0; i < 4; ++i) {
      pz_point by = pz_newton_step(pz_see(PZ_P c, stop), q);
      step2 = by.x * by.x + by.y * by.y;
      stop = pz_xy(stop.x + by.x, stop.y + by.y);
      float r2 = stop.x * stop.x + stop.y * stop.y; /* stays near the rim: outside, the polynomials are not fitted */
      if (r2 > 2.25f) stop = pz_xy(stop.x * 1.5f / PZ_SQRT(r2), stop.y * 1.5f / PZ_SQRT(r2));
    }
    area = pz_abs(pz_determinant(pz_see(PZ_P c, stop)));
    stop = pz_to_film(c, pz_xy(stop.x / scale, stop.y / scale));
    if (!(step2 < 1.0e-6f && stop.x * stop.x + stop.y * stop.y <= 1.000001f)) return 0.0f;
    for (int e = 0; e < blades; ++e) {
      if (pz_inside(PZ_P pz_unit_edges(PZ_P blades), e, stop.x, stop.y) < 0.0f) return 0.0f;
    }
    return PZ_AT(PZ_IRIS_AREA) * scale * scale * area;
  }
  q = pz_xy(q.x - middle.x, q.y - middle.y);
  pz_point first = pz_corner(PZ_P c, 0);
  for (int step = 32; step > 0; step /= 2) {
    if (pz_comes_before(first, pz_corner(PZ_P c, k + step), q)) k += step;
  }
  pz_sector own = pz_sector_of(PZ_P c, k);
  float squared = pz_squared_at(own, q);
  if (!(squared >= 0.0f)) return 0.0f;
  if (bladed) {
    float behind = pz_turn(own.a, q), before = pz_turn(q, own.b);
    float along = behind + before > 0.0f ? behind / (behind + before) : 0.0f;
    interval = pz_clip(PZ_P c, k, along, pz_on_edge(own, along));
  }
  interval = pz_xy(interval.x * interval.x, interval.y * interval.y);
  if (!(squared <= interval.y && squared >= interval.x) || pz_is_dark(own, squared)) return 0.0f;
  float fraction = bladed ? pz_fraction_within(own, interval.y) - pz_fraction_within(own, interval.x) : 1.0f;
  return pz_whole_area(PZ_P c) * fraction;
}

/* ---- Rays through the surfaces ---- */

/* A ray on its way. z counts from the vertex of the surface, along the direction of travel; p is the direction times
 * the index of the medium, so that refraction needs no division. A follower is a derivative of position and p. */
PZ_STRUCT(pz_follower) { pz_vector at, p; };
PZ_STRUCT(pz_beam) {
  pz_vector at, p;
  pz_follower by_x, by_y;
  float sense; /* 1: light travels towards +z */
  int fate;
};
/* Sag z of an asphere at a squared height u: z, slope = 2 dz/du, bend = d slope / du. */
PZ_STRUCT(pz_sag) {
  PZ_BOOL defined;
  float z, slope, bend;
};
PZ_FN pz_sag pz_sag_of(PZ_T int surface, float u) {
  pz_sag s;
  float c = PZ_AT(surface + 2), e = PZ_AT(surface + 3), inside = 1.0f - e * c * c * u;
  float root = PZ_SQRT(inside > 0.0f ? inside : 0.0f);
  int asphere = pz_whole(PZ_P surface + 10);
  s.defined = inside > 0.0f;
  s.z = c * u / (1.0f + root);
  s.slope = s.defined ? c / root : 0.0f;
  s.bend = s.defined ? 0.5f * e * c * c * c / (root * inside) : 0.0f;
  if (asphere != 0) { /* even terms v, v^2, ... and odd terms rho v, rho v^2, ... with v = rho^2 = u / height^2 */
    float height2 = PZ_AT(asphere) * PZ_AT(asphere), v = u / height2, rho = PZ_SQRT(v);
    int even = pz_whole(PZ_P asphere + 2), odd = pz_whole(PZ_P asphere + 3);
    float p = 0.0f, p1 = 0.0f, p2 = 0.0f, q = 0.0f, q1 = 0.0f, q2 = 0.0f;
    for (int i = even - 1; i >= -1; --i) {
      p2 = p2 * v + 2.0f * p1;
      p1 = p1 * v + p;
      p = p * v + (i >= 0 ? PZ_AT(asphere + 4 + i) : 0.0f);
    }
    for (int i = odd - 1; i >= -1; --i) {
      q2 = q2 * v + 2.0f * q1;
      q1 = q1 * v + q;
      q = q * v + (i >= 0 ? PZ_AT(asphere + 4 + even + i) : 0.0f);
    }
    s.z += p + rho * q;
    s.slope += 2.0f * (p1 + (rho > 1.0e-9f ? rho * q1 + 0.5f * q / rho : 0.0f)) / height2;
    if (rho > 1.0e-9f) p2 += rho * q2 + q1 / rho - 0.25f * q / (rho * v);
    s.bend += 2.0f * p2 / (height2 * height2);
  }
  return s;
}

/* A point of a surface, where N = (-g.x, -g.y, g.z) is half the gradient of its equation. */
PZ_STRUCT(pz_contact) {
  pz_vector p; /* in front of the surface */
  pz_vector g;
  pz_vector c;                   /* N changes by -(c.x dx, c.y dy, c.z dz) ... */
  float twist, ax, ay;           /* ... - twist (ax x, ay y, 0) (ax x dx + ay y dy) */
  float q, nn, xi, xo, gamma, k; /* distance in units of p, N N, p N, p' N, (p' N - p N) / nn, n'^2 - n^2 */
};
/* The derivative of a ray behind a surface by the chain rule. at: the point of the surface */
PZ_FN pz_follower pz_follow(pz_follower d, pz_vector at, pz_contact s, PZ_BOOL mirror) {
  float on, gamma;
  pz_vector n;
  d.at = pz_along(d.at, s.q, d.p);
  on = (s.g.x * d.at.x + s.g.y * d.at.y - s.g.z * d.at.z) / s.xi; /* the point stays on the surface */
  d.at = pz_along(d.at, on, s.p);
  float h = s.ax * at.x * d.at.x + s.ay * at.y * d.at.y;
  n.x = s.c.x * d.at.x + s.twist * s.ax * at.x * h;
  n.y = s.c.y * d.at.y + s.twist * s.ay * at.y * h;
  n.z = s.c.z * d.at.z;
  float xi = s.g.z * d.p.z - s.g.x * d.p.x - s.g.y * d.p.y - pz_dot(n, s.p);
  gamma =
      -s.gamma / s.xo * xi + 2.0f * (0.5f * s.k / s.xo - s.gamma) / s.nn * (s.g.x * n.x + s.g.y * n.y - s.g.z * n.z);
  d.p.x = d.p.x - gamma * s.g.x - s.gamma * n.x;
  d.p.y = d.p.y - gamma * s.g.y - s.gamma * n.y;
  d.p.z = d.p.z + gamma * s.g.z - s.gamma * n.z;
  if (mirror) d.at.z = -d.at.z;
  if (mirror) d.p.z = -d.p.z;
  return d;
}

PZ_FN pz_beam pz_stopped(pz_beam b, int fate) {
  b.fate = fate;
  return b;
}
/* One surface. n2: squared index in front of it; k: change of the squared index; clips: apertures clip the ray. */
PZ_FN pz_beam pz_pass(PZ_T pz_beam b, int surface, float n2, float k, PZ_BOOL clips, PZ_BOOL follow) {
  float c = b.sense * PZ_AT(surface + 2), e = PZ_AT(surface + 3);
  float ax = PZ_AT(surface + 4), ay = PZ_AT(surface + 5), rim2 = PZ_AT(surface + 6), r2, d;
  float quadratic, facing, free, shift;
  int asphere = pz_whole(PZ_P surface + 10);
  PZ_BOOL mirror = PZ_AT(surface + 8) != 0.0f, sphere = asphere == 0 && e == 1.0f && ax * ay == 1.0f, found = PZ_TRUE;
  pz_vector at = b.at, p = b.p;
  pz_contact s;
  /* Near the vertex the quadratic loses no digits: go to its plane, or to the nearest point if the ray is steep. */
  if (p.z * pz_abs(p.z) > 0.09f * n2) {
    shift = -at.z / p.z;
    at = pz_xyz(at.x + shift * p.x, at.y + shift * p.y, 0.0f);
  } else {
    shift = -(ax * at.x * p.x + ay * at.y * p.y + at.z * p.z) / (ax * p.x * p.x + ay * p.y * p.y + p.z * p.z);
    at = pz_along(at, shift, p);
  }
  if (follow) {
    b.by_x.at = pz_along(b.by_x.at, shift, b.by_x.p);
    b.by_y.at = pz_along(b.by_y.at, shift, b.by_y.p);
  }
  /* quadratic q^2 - 2 facing q + free = 0 for the base conic */
  quadratic = c * (ax * p.x * p.x + ay * p.y * p.y + e * p.z * p.z);
  facing = p.z - c * (ax * at.x * p.x + ay * at.y * p.y + e * at.z * p.z);
  free = c * (ax * at.x * at.x + ay * at.y * at.y + e * at.z * at.z) - 2.0f * at.z;
  d = facing * facing - quadratic * free;
  float root = PZ_SQRT(d > 0.0f ? d : 0.0f);
  s.p = p;
  s.ax = ax;
  s.ay = ay;
  s.twist = 0.0f;
  if (asphere == 0) {
    found = d >= 0.0f;
    s.q = facing >= 0.0f ? free / (facing + root) : (facing - root) / quadratic;
    at = pz_along(at, s.q, p);
    s.g = pz_xyz(c * ax * at.x, c * ay * at.y, 1.0f - c * e * at.z);
    s.c = pz_xyz(c * ax, c * ay, c * e);
    s.xi = root;
    found = found && s.g.z > 0.0f && pz_finite(s.q);
  } else {
    float size = PZ_AT(asphere) + ax * pz_abs(at.x) + ay * pz_abs(at.y) + pz_abs(at.z), u;
    pz_sag sag;
    PZ_BOOL settled = PZ_FALSE;
    s.q = d > 0.0f && facing > 0.0f ? free / (facing + root) : 0.0f;
    for (int i = 0; i < 12 && !settled; ++i) { /* Newton's method */
      pz_vector on = pz_along(at, s.q, p);
      sag = pz_sag_of(PZ_P surface, ax * on.x * on.x + ay * on.y * on.y);
      float above = on.z - b.sense * sag.z;
      s.xi = p.z - b.sense * sag.slope * (ax * on.x * p.x + ay * on.y * p.y);
      settled = sag.defined && pz_abs(above) <= 2.4e-7f * (size + pz_abs(s.q));
      s.q -= above / s.xi;
    }
    at = pz_along(at, s.q, p);
    u = ax * at.x * at.x + ay * at.y * at.y;
    s.g = pz_xyz(b.sense * sag.slope * ax * at.x, b.sense * sag.slope * ay * at.y, 1.0f);
    s.c = pz_xyz(b.sense * sag.slope * ax, b.sense * sag.slope * ay, 0.0f);
    s.twist = 2.0f * b.sense * sag.bend;
    if (clips && !(u <= PZ_AT(asphere + 1))) return pz_stopped(b, 3);
    found = settled && s.xi > 0.0f;
  }
  b.at = at;
  r2 = at.x * at.x + at.y * at.y;
  if (!found) return pz_stopped(b, 1);
  if (clips && !(r2 <= rim2 && r2 >= PZ_AT(surface + 7))) return pz_stopped(b, 3);
  if (clips && PZ_AT(surface + 9) != 0.0f) {
    int blades = pz_whole(PZ_P PZ_BLADES), edges = pz_whole(PZ_P PZ_EDGES);
    for (int i = 0; i < blades; ++i) {
      if (pz_inside(PZ_P edges, i, at.x, at.y) < 0.0f) return pz_stopped(b, 3);
    }
  }
  s.nn = sphere ? 1.0f : pz_dot(s.g, s.g);
  s.k = mirror ? 0.0f : k;
  if (!mirror && k == 0.0f) {
    s.xo = s.xi;
    s.gamma = 0.0f;
  } else if (mirror) {
    s.xo = -s.xi;
    s.gamma = -2.0f * s.xi / s.nn;
  } else {
    d = (asphere == 0 ? d : s.xi * s.xi) + k * s.nn;
    if (!(d >= 0.0f)) return pz_stopped(b, 2);
    s.xo = PZ_SQRT(d);
    s.gamma = k / (s.xo + s.xi);
  }
  b.p = pz_xyz(p.x - s.gamma * s.g.x, p.y - s.gamma * s.g.y, p.z + s.gamma * s.g.z);
  if (follow) {
    b.by_x = pz_follow(b.by_x, at, s, mirror);
    b.by_y = pz_follow(b.by_y, at, s, mirror);
  }
  if (mirror) {
    b.at.z = -b.at.z;
    b.p.z = -b.p.z;
    b.sense = -b.sense;
  }
  return b;
}

/* Traces a ray in the lens frame through all surfaces, to the film or to the scene. follow: with derivatives. */
PZ_FN pz_beam pz_trace(PZ_T pz_beam b, pz_light light, PZ_BOOL to_film, PZ_BOOL clips, PZ_BOOL follow) {
  int count = pz_whole(PZ_P PZ_SURFACE_COUNT), list = pz_whole(PZ_P PZ_SURFACES);
  int odd = pz_whole(PZ_P PZ_MIRRORS) % 2, surface = list + (to_film ? 0 : count - 1) * PZ_SURFACE_SIZE;
  float n = PZ_SQRT(pz_number(PZ_P light, to_film ? 4 : 4 + count)), length, scale;
  b.sense = to_film || odd != 0 ? 1.0f : -1.0f;
  b.fate = 0;
  b.at.z = b.sense * (b.at.z - PZ_AT(surface));
  b.p = pz_xyz(n * b.p.x, n * b.p.y, b.sense * n * b.p.z);
  if (follow) {
    b.by_x.at.z *= b.sense;
    b.by_y.at.z *= b.sense;
    b.by_x.p = pz_xyz(n * b.by_x.p.x, n * b.by_x.p.y, b.sense * n * b.by_x.p.z);
    b.by_y.p = pz_xyz(n * b.by_y.p.x, n * b.by_y.p.y, b.sense * n * b.by_y.p.z);
  }
  for (int j = 0; j < count; ++j) {
    int i = to_film ? j : count - 1 - j;
    float n2 = pz_number(PZ_P light, to_film ? 4 + i : 5 + i), k = pz_number(PZ_P light, 5 + count + i);
    surface = list + i * PZ_SURFACE_SIZE;
    if (j > 0) {
      b.at.z -= b.sense * (to_film ? PZ_AT(surface - PZ_SURFACE_SIZE + 1) : -PZ_AT(surface + 1));
      if (j % 16 == 0) {
        scale = 1.5f - 0.5f * pz_dot(b.p, b.p) / n2;
        b.p = pz_xyz(scale * b.p.x, scale * b.p.y, scale * b.p.z);
      }
    }
    b = pz_pass(PZ_P b, surface, n2, to_film ? k : -k, clips, follow);
    if (b.fate != 0) return b;
  }
  n = PZ_SQRT(pz_number(PZ_P light, to_film ? 4 + count : 4));
  b.at.z = b.sense * b.at.z + PZ_AT(surface);
  length = pz_dot(b.p, b.p) / (n * n);
  scale = (1.5f - 0.5f * length) / n;
  b.p = pz_xyz(scale * b.p.x, scale * b.p.y, b.sense * scale * b.p.z);
  if (!(pz_abs(length - 1.0f) < 1.2e-5f)) b.fate = 1;
  if (follow) {
    b.by_x.at.z *= b.sense;
    b.by_y.at.z *= b.sense;
    b.by_x.p = pz_xyz(b.by_x.p.x / n, b.by_x.p.y / n, b.sense * b.by_x.p.z / n);
    b.by_y.p = pz_xyz(b.by_y.p.x / n, b.by_y.p.y / n, b.sense * b.by_y.p.z / n);
  }
  return b;
}

/* ---- Rays by polynomials ---- */

/* A ray in object space as two vectors s and o that turn with it about the axis: s is the stereographic projection of
 * the direction, o the foot of the perpendicular from the reference point. Each is A f + B p, with f and p the film
 * and pupil point, scaled, and polynomials A and B. */
PZ_STRUCT(pz_chart) { float sx, sy, ox, oy; };
PZ_FN pz_chart pz_sums(PZ_T int w, float fx, float fy, float px, float py) {
  int n = (pz_whole(PZ_P PZ_DEGREE) - 1) / 2, list = pz_whole(PZ_P PZ_TERMS), at;
  int of_three = (n + 1) * (n + 2) * (n + 3) / 6, of_four = (n + 1) * (n + 2) * (n + 3) * (n + 2) / 12;
  PZ_BOOL two = PZ_AT(PZ_PUPIL_DIMENSIONS) == 2.0f;
  int terms = two ? of_four : of_three, stride = two ? 2 * terms : terms;
  pz_chart chart;
  float a[4];
  /* Along x and y: f and p along this axis, g and q along the other. Lenses of revolution have the same polynomials
   * of f f, f p and p p for both axes. */
  for (int axis = 0; axis < 2; ++axis) {
    float f = axis == 0 ? fx : fy, p = axis == 0 ? px : py, g = axis == 0 ? fy : fx, q = axis == 0 ? py : px;
    float u = two ? f * f : f * f + g * g, v = two ? p * p : f * p + g * q, r = two ? g * g : p * p + q * q;
    at = list + (two ? terms * (8 * w + axis) : 4 * terms * w);
    for (int m = 0; m < 4; ++m) a[m] = 0.0f;
    for (int odd = 0; odd < (two ? 2 : 1); ++odd) {
      float by_q = odd == 1 ? g * q : 1.0f;
      for (int l = 0; l <= (two ? n - odd : 0); ++l) {
        float by_r = by_q;
        for (int k = 0; k <= n - odd - l; ++k) {
          float by_v = by_r;
          for (int j = 0; j <= n - odd - l - k; ++j) {
            float term = by_v;
            for (int i = 0; i <= n - odd - l - k - j; ++i) {
              for (int m = 0; m < 4; ++m) a[m] += PZ_AT(at + m * stride) * term;
              term *= u;
              ++at;
            }
            by_v *= v;
          }
          by_r *= r;
        }
        by_q *= q * q;
      }
    }
    if (axis == 0) chart.sx = a[0] * f + a[1] * p;
    if (axis == 0) chart.ox = a[2] * f + a[3] * p;
    if (axis == 1) chart.sy = a[0] * f + a[1] * p;
    if (axis == 1) chart.oy = a[2] * f + a[3] * p;
  }
  return chart;
}
PZ_FN pz_beam pz_by_polynomial(PZ_T int w, pz_point film, pz_point pupil) {
  pz_beam b;
  float fx = film.x / PZ_AT(PZ_DOMAIN_FILM), fy = film.y / PZ_AT(PZ_DOMAIN_FILM);
  float px = (pupil.x - PZ_AT(PZ_DOMAIN_SHIFT_X) * film.x) / PZ_AT(PZ_DOMAIN_RADIUS_X);
  float py = (pupil.y - PZ_AT(PZ_DOMAIN_SHIFT_Y) * film.y) / PZ_AT(PZ_DOMAIN_RADIUS_Y);
  b.fate = fx * fx + fy * fy <= 1.00001f && px * px + py * py <= 1.00001f ? 0 : 5;
  pz_chart c = pz_sums(PZ_P w, fx, fy, px, py);
  float square = c.sx * c.sx + c.sy * c.sy, twice = 2.0f / (square + 1.0f);
  float along = twice * (c.sx * c.ox + c.sy * c.oy);
  b.at = pz_xyz(c.ox - c.sx * along, c.oy - c.sy * along, along + PZ_AT(PZ_REFERENCE_Z));
  b.p = pz_xyz(twice * c.sx, twice * c.sy, twice * (square - 1.0f) / 2.0f);
  return b;
}

/* ---- From the film to the scene ---- */

/* Distance along a ray towards the scene to the front of the lens: a sphere through the front vertex, or a plane. */
PZ_FN float pz_to_front(PZ_T pz_vector o, pz_vector d) {
  float c = PZ_AT(PZ_FRONT_CURVATURE), z = o.z - PZ_AT(PZ_FRONT_Z);
  float e = c * (o.x * o.x + o.y * o.y + z * z) - 2.0f * z, along = o.x * d.x + o.y * d.y + z * d.z;
  float b = d.z - c * along, square = b * b - c * e;
  if (square > 0.0f && (b < 0.0f || c != 0.0f)) {
    float root = PZ_SQRT(square);
    return b < 0.0f ? e / (b - root) : (b + root) / c;
  }
  return d.z < 0.0f ? -z / d.z : -along;
}
/* A film point and a point of its pupil: before the ray is known. */
PZ_STRUCT(pz_start) {
  pz_light light;
  pz_point film;
  pz_cell cell;
  pz_pupil_sample pupil;
  int fate;
};
PZ_FN pz_start pz_start_of(PZ_T float x, float y, float u, float v, float nm) {
  pz_start s;
  float sound = (u + v) * 0.0f; /* NaN unless u and v are finite */
  s.light = pz_light_of(PZ_P nm);
  s.film = pz_xy(x, y);
  s.fate = 0;
  if (!pz_on_film(PZ_P x, y)) {
    s.fate = 6;
  } else if (!(sound >= 0.0f)) {
    s.fate = 3;
  } else if (s.light.nearest < 0 || (PZ_AT(PZ_RAYS) == 1.0f && !s.light.compiled)) {
    s.fate = 8;
  }
  if (s.fate != 0) return s;
  s.cell = pz_find_cell(PZ_P x, y, s.light.nearest);
  s.pupil = pz_sample_pupil(PZ_P s.cell, u, v);
  if (!(s.pupil.area > 0.0f)) s.fate = 3;
  return s;
}
/* The derivatives of the middle of a pupil by the film point. */
PZ_FN pz_seen pz_motion(PZ_T pz_start s) {
  pz_seen by;
  float per_mm = PZ_AT(PZ_ROWS_PER_MM), sine = s.cell.sine, cosine = s.cell.cosine;
  int b = s.cell.begin;
  by.at = s.film;
  if (!s.cell.two) {
    float r = PZ_SQRT(s.film.x * s.film.x + s.film.y * s.film.y), along = PZ_AT(b + 3) * per_mm;
    float across = r * per_mm >= 1.0f ? pz_value(PZ_P s.cell, b + 2) / r : along;
    by.by_x = pz_xy(along * sine * sine + across * cosine * cosine, (along - across) * sine * cosine);
    by.by_y = pz_xy(by.by_x.y, along * cosine * cosine + across * sine * sine);
  } else {
    int columns = pz_whole(PZ_P PZ_PUPIL_COLUMNS), rows = pz_whole(PZ_P PZ_PUPIL_ROWS);
    int half_width = pz_whole(PZ_P PZ_HALF_WIDTHS) + s.cell.cell / columns % rows;
    float t = s.cell.t, v = s.cell.s, change = PZ_AT(half_width + 1) - PZ_AT(half_width);
    float width = PZ_AT(half_width) + v * change, per = width > 0.0f ? 1.0f / width : 0.0f;
    float t_by_x = PZ_FLOAT(columns) * per, t_by_y = -(PZ_FLOAT(s.cell.cell % columns) + t) * change * per_mm * per;
    float x_by_t = PZ_AT(b + 1) + v * PZ_AT(b + 3), x_by_s = PZ_AT(b + 2) + t * PZ_AT(b + 3);
    float y_by_t = PZ_AT(b + 5) + v * PZ_AT(b + 7), y_by_s = PZ_AT(b + 6) + t * PZ_AT(b + 7);
    by.by_x = pz_xy(x_by_t * t_by_x, sine * cosine * y_by_t * t_by_x);
    by.by_y = pz_xy(sine * cosine * (x_by_s * per_mm + x_by_t * t_by_y), y_by_s * per_mm + y_by_t * t_by_y);
  }
  return by;
}
PZ_FN pz_ray pz_lost(int fate) {
  pz_ray ray;
  ray.origin = pz_xyz(0.0f, 0.0f, 0.0f);
  ray.direction = pz_xyz(0.0f, 0.0f, -1.0f);
  ray.weight = 0.0f;
  ray.pdf_pupil = 0.0f;
  ray.fate = fate;
  return ray;
}
PZ_FN pz_vector pz_difference(pz_vector a, pz_vector b, float per) {
  return pz_xyz((a.x - b.x) * per, (a.y - b.y) * per, (a.z - b.z) * per);
}
/* The ray of a start, in the plane where its model ends, with derivatives if follow is true. */
PZ_FN pz_beam pz_leave(PZ_T pz_start s, PZ_BOOL follow) {
  pz_beam b;
  pz_point pupil = s.pupil.at;
  float depth = PZ_AT(PZ_PUPIL_Z) - PZ_AT(PZ_FILM_Z), sign, per, x, y;
  if (PZ_AT(PZ_RAYS) == 1.0f) {
    b = pz_by_polynomial(PZ_P s.light.nearest, s.film, pupil);
    if (follow) { /* central differences */
      pz_seen motion = pz_motion(PZ_P s);
      float h = 0.004f * PZ_AT(PZ_DOMAIN_FILM);
      for (int axis = 0; axis < 2; ++axis) {
        pz_point df = axis == 0 ? pz_xy(h, 0.0f) : pz_xy(0.0f, h), dp = axis == 0 ? motion.by_x : motion.by_y;
        dp = pz_xy(h * dp.x, h * dp.y);
        pz_beam more = pz_by_polynomial(PZ_P s.light.nearest, pz_xy(s.film.x + df.x, s.film.y + df.y),
                                        pz_xy(pupil.x + dp.x, pupil.y + dp.y));
        pz_beam less = pz_by_polynomial(PZ_P s.light.nearest, pz_xy(s.film.x - df.x, s.film.y - df.y),
                                        pz_xy(pupil.x - dp.x, pupil.y - dp.y));
        pz_follower by;
        by.at = pz_difference(more.at, less.at, 0.5f / h);
        by.p = pz_difference(more.p, less.p, 0.5f / h);
        if (axis == 0) b.by_x = by;
        if (axis == 1) b.by_y = by;
      }
    }
    return b;
  }
  x = pupil.x - s.film.x;
  y = pupil.y - s.film.y;
  /* Light leaves the lens towards -z, or towards +z after an odd number of mirrors. */
  sign = pz_whole(PZ_P PZ_MIRRORS) % 2 == 0 ? -1.0f : 1.0f;
  per = (depth < 0.0f ? -sign : sign) / PZ_SQRT(x * x + y * y + depth * depth);
  b.at = pz_xyz(pupil.x, pupil.y, PZ_AT(PZ_PUPIL_Z));
  b.p = pz_xyz(x * per, y * per, depth * per);
  if (follow) { /* of pupil - film, less its part along the ray */
    pz_seen motion = pz_motion(PZ_P s);
    b.by_x.at = pz_xyz(motion.by_x.x, motion.by_x.y, 0.0f);
    b.by_y.at = pz_xyz(motion.by_y.x, motion.by_y.y, 0.0f);
    b.by_x.p = pz_xyz((motion.by_x.x - 1.0f) * per, motion.by_x.y * per, 0.0f);
    b.by_y.p = pz_xyz(motion.by_y.x * per, (motion.by_y.y - 1.0f) * per, 0.0f);
    float along = pz_dot(b.by_x.p, b.p);
    b.by_x.p = pz_along(b.by_x.p, -along, b.p);
    along = pz_dot(b.by_y.p, b.p);
    b.by_y.p = pz_along(b.by_y.p, -along, b.p);
  }
  return pz_trace(PZ_P b, s.light, PZ_FALSE, PZ_TRUE, follow);
}
/* The camera ray of a start and its beam: with weight, and from the front of the lens. */
PZ_FN pz_ray pz_ray_of(PZ_T pz_start s, pz_beam b) {
  pz_ray ray = pz_lost(b.fate);
  float depth = PZ_AT(PZ_PUPIL_Z) - PZ_AT(PZ_FILM_Z), x, y, factor;
  ray.pdf_pupil = 1.0f / s.pupil.area;
  if (b.fate != 0) return ray;
  x = s.pupil.at.x - s.film.x;
  y = s.pupil.at.y - s.film.y;
  factor = depth / (x * x + y * y + depth * depth);
  ray.origin = b.at;
  ray.direction = b.p;
  ray.weight = pz_number(PZ_P s.light, 0) * s.pupil.area * factor * factor;
  if (PZ_AT(PZ_RAYS) == 1.0f || PZ_AT(PZ_FRONT_FIRST) == 0.0f) {
    ray.origin = pz_along(ray.origin, pz_to_front(PZ_P ray.origin, ray.direction), ray.direction);
  }
  return ray;
}
/* A camera ray from a film point (mm), a pupil sample (u, v from 0 to 1) and a wavelength (nm). */
PZ_FN pz_ray pz_sample(PZ_T float film_x, float film_y, float u, float v, float nm) {
  pz_start s = pz_start_of(PZ_P film_x, film_y, u, v, nm);
  if (s.fate != 0) return pz_lost(s.fate);
  return pz_ray_of(PZ_P s, pz_leave(PZ_P s, PZ_FALSE));
}
/* The same ray with its derivatives by the film point, for texture filters. The offset of the pupil point from the
 * middle of the pupil is constant. */
PZ_FN pz_ray_differential pz_sample_differential(PZ_T float film_x, float film_y, float u, float v, float nm) {
  pz_start s = pz_start_of(PZ_P film_x, film_y, u, v, nm);
  pz_ray_differential result;
  result.ray = pz_lost(s.fate);
  result.origin_by_x = result.direction_by_x = result.origin_by_y = result.direction_by_y = pz_xyz(0.0f, 0.0f, 0.0f);
  if (s.fate != 0) return result;
  pz_beam b = pz_leave(PZ_P s, PZ_TRUE);
  result.ray = pz_ray_of(PZ_P s, b);
  if (b.fate != 0) return result;
  /* rays that graze a surface have no finite derivatives */
  if (!pz_finite(pz_dot(b.by_x.p, b.by_x.p) + pz_dot(b.by_y.p, b.by_y.p))) return result;
  result.direction_by_x = b.by_x.p;
  result.direction_by_y = b.by_y.p;
  /* from b.at to the front, on which origins stay: N (by + t d_by + t_by d) = 0 */
  {
    pz_vector o = result.ray.origin, d = result.ray.direction, n;
    float c = PZ_AT(PZ_FRONT_CURVATURE), t = pz_dot(pz_difference(o, b.at, 1.0f), d), per;
    pz_vector x = pz_along(b.by_x.at, t, b.by_x.p), y = pz_along(b.by_y.at, t, b.by_y.p);
    n = pz_xyz(c * o.x, c * o.y, c * (o.z - PZ_AT(PZ_FRONT_Z)) - 1.0f);
    per = pz_dot(n, d);
    result.origin_by_x = pz_along(x, -pz_dot(n, x) / per, d);
    result.origin_by_y = pz_along(y, -pz_dot(n, y) / per, d);
  }
  return result;
}

/* ---- From the scene to the film ---- */

/* A ray of the scene behind the lens: its film point and its pupil point. */
PZ_STRUCT(pz_path) {
  pz_point film, pupil;
  int fate;
};
/* The film and pupil point whose ray by polynomials has the line of a ray, by Newton's method from a point nearby. */
PZ_FN pz_path pz_corrected(PZ_T pz_path path, pz_vector origin, pz_vector direction, int w) {
  float x[4], a[20], z = origin.z - PZ_AT(PZ_REFERENCE_Z), per = 1.0f / (1.0f + direction.z), off = 1.0f, shift, along;
  float sx = -direction.x * per, sy = -direction.y * per, foot;
  pz_chart line_chart, here;
  along = origin.x * direction.x + origin.y * direction.y + z * direction.z;
  foot = z - along * direction.z;
  line_chart.sx = sx;
  line_chart.sy = sy;
  line_chart.ox = origin.x - along * direction.x + foot * sx;
  line_chart.oy = origin.y - along * direction.y + foot * sy;
  x[0] = path.film.x / PZ_AT(PZ_DOMAIN_FILM);
  x[1] = path.film.y / PZ_AT(PZ_DOMAIN_FILM);
  x[2] = (path.pupil.x - PZ_AT(PZ_DOMAIN_SHIFT_X) * path.film.x) / PZ_AT(PZ_DOMAIN_RADIUS_X);
  x[3] = (path.pupil.y - PZ_AT(PZ_DOMAIN_SHIFT_Y) * path.film.y) / PZ_AT(PZ_DOMAIN_RADIUS_Y);
  for (int i = 0; i < 5 && off > 1.0e-6f; ++i) {
    here = pz_sums(PZ_P w, x[0], x[1], x[2], x[3]);
    a[4] = line_chart.sx - here.sx;
    a[9] = line_chart.sy - here.sy;
    a[14] = line_chart.ox - here.ox;
    a[19] = line_chart.oy - here.oy;
    for (int k = 0; k < 4; ++k) { /* derivatives by differences */
      float h = 0.015625f;
      pz_chart next = pz_sums(PZ_P w, k == 0 ? x[0] + h : x[0], k == 1 ? x[1] + h : x[1], k == 2 ? x[2] + h : x[2],
                              k == 3 ? x[3] + h : x[3]);
      a[k] = (next.sx - here.sx) / h;
      a[5 + k] = (next.sy - here.sy) / h;
      a[10 + k] = (next.ox - here.ox) / h;
      a[15 + k] = (next.oy - here.oy) / h;
    }
    for (int k = 0; k < 4; ++k) { /* elimination; the pivot is the largest element of the column */
      int pivot = k;
      for (int r = k + 1; r < 4; ++r) {
        if (pz_abs(a[5 * r + k]) > pz_abs(a[5 * pivot + k])) pivot = r;
      }
      for (int j = 0; j < 5; ++j) {
        float above = a[5 * k + j];
        a[5 * k + j] = a[5 * pivot + j];
        a[5 * pivot + j] = above;
      }
      for (int r = 0; r < 4; ++r) {
        float factor = a[5 * r + k] / a[5 * k + k];
        for (int j = k; j < 5 && r != k; ++j) a[5 * r + j] -= factor * a[5 * k + j];
      }
    }
    off = 0.0f;
    for (int k = 0; k < 4; ++k) {
      shift = a[5 * k + 4] / a[5 * k + k];
      x[k] += shift;
      off += pz_abs(shift);
    }
  }
  path.fate = off < 1.0e-3f && x[0] * x[0] + x[1] * x[1] <= 1.00001f && x[2] * x[2] + x[3] * x[3] <= 1.00001f ? 0 : 5;
  path.film = pz_xy(x[0] * PZ_AT(PZ_DOMAIN_FILM), x[1] * PZ_AT(PZ_DOMAIN_FILM));
  path.pupil = pz_xy(x[2] * PZ_AT(PZ_DOMAIN_RADIUS_X) + PZ_AT(PZ_DOMAIN_SHIFT_X) * path.film.x,
                     x[3] * PZ_AT(PZ_DOMAIN_RADIUS_Y) + PZ_AT(PZ_DOMAIN_SHIFT_Y) * path.film.y);
  return path;
}
/* origin: a point of the ray near the lens */
PZ_FN pz_path pz_arrive(PZ_T pz_vector origin, pz_vector direction, pz_light light) {
  pz_path path;
  pz_beam b;
  PZ_BOOL exact = PZ_AT(PZ_RAYS) == 0.0f;
  path.film = path.pupil = pz_xy(0.0f, 0.0f);
  b.at = origin;
  b.p = direction;
  b = pz_trace(PZ_P b, light, PZ_TRUE, exact, PZ_FALSE);
  path.fate = b.fate;
  if (b.fate != 0) return path;
  float to = (PZ_AT(PZ_FILM_Z) - b.at.z) / b.p.z;
  path.film = pz_xy(b.at.x + to * b.p.x, b.at.y + to * b.p.y);
  to = (PZ_AT(PZ_PUPIL_Z) - b.at.z) / b.p.z;
  path.pupil = pz_xy(b.at.x + to * b.p.x, b.at.y + to * b.p.y);
  if (!pz_finite(path.film.x + path.film.y + path.pupil.x + path.pupil.y)) path.fate = 1;
  return exact || path.fate != 0 ? path : pz_corrected(PZ_P path, origin, direction, light.nearest);
}
PZ_FN pz_arrival pz_dark(pz_arrival found, int fate) {
  found.we = found.pdf_film = found.pdf_pupil = found.pdf_position = found.pdf_direction = 0.0f;
  found.fate = fate;
  return found;
}
/* The importance of a ray of the scene, with unit direction into the lens. */
PZ_FN pz_arrival pz_importance(PZ_T pz_vector origin, pz_vector direction, float nm) {
  pz_arrival found;
  pz_light light = pz_light_of(PZ_P nm);
  float depth = PZ_AT(PZ_PUPIL_Z) - PZ_AT(PZ_FILM_Z), x, y, length2, area, density;
  float length = pz_dot(direction, direction), sound = pz_dot(origin, direction) * 0.0f;
  found.film = pz_xy(0.0f, 0.0f);
  if (light.nearest < 0 || (PZ_AT(PZ_RAYS) == 1.0f && !light.compiled)) return pz_dark(found, 8);
  if (!(sound >= 0.0f && pz_abs(length - 1.0f) < 1.0e-3f)) return pz_dark(found, 7);
  origin = pz_along(origin, -pz_dot(origin, direction), direction); /* the point nearest to the first vertex */
  length = 1.5f - 0.5f * length;
  direction = pz_xyz(length * direction.x, length * direction.y, length * direction.z);
  pz_path path = pz_arrive(PZ_P origin, direction, light);
  if (path.fate != 0) return pz_dark(found, path.fate);
  found.film = path.film;
  if (!pz_on_film(PZ_P found.film.x, found.film.y)) return pz_dark(found, 6);
  area = pz_area_at(PZ_P pz_find_cell(PZ_P found.film.x, found.film.y, light.nearest), path.pupil.x, path.pupil.y);
  if (!(area > 0.0f)) return pz_dark(found, 3);
  x = path.pupil.x - found.film.x;
  y = path.pupil.y - found.film.y;
  length2 = x * x + y * y + depth * depth;
  density = pz_number(PZ_P light, 2);
  found.fate = 0;
  found.we = pz_number(PZ_P light, 1);
  found.pdf_film = 1.0f / (PZ_AT(PZ_FILM_WIDTH) * PZ_AT(PZ_FILM_HEIGHT));
  found.pdf_pupil = 1.0f / area;
  area = pz_number(PZ_P light, 3);
  found.pdf_position = area < 3.0e38f ? 1.0f / area : 1.0f; /* a pupil at infinity has no position */
  found.pdf_direction = density * length2 * length2 * found.pdf_pupil / found.pdf_position;
  return found;
}

/* The pupil of a scene point: a polygon in the plane through the centre that faces the point, interpolated between
 * nodes over reciprocal distance and field (one angle for a lens of revolution, two angles with cylinders). */
PZ_STRUCT(pz_scene) {
  PZ_BOOL known, two; /* two: two angles */
  int nodes;          /* position of the numbers of the first node in the table */
  float weight[8];
  float distance, sine, cosine, azimuth_x, azimuth_y; /* sine, cosine: of the field */
};
PZ_FN float pz_last_field(PZ_T pz_scene s, int w, float at, int angle) {
  int angles = s.two ? 2 : 1, list = pz_whole(PZ_P PZ_WIDEST) + w * 3 * angles + angle, i = at < 0.5f ? 0 : 1;
  float low = PZ_AT(list + i * angles), high = PZ_AT(list + (i + 1) * angles);
  return low + (2.0f * at - PZ_FLOAT(i)) * (high - low);
}
PZ_FN pz_scene pz_find_scene(PZ_T pz_vector from, int w) {
  pz_scene s;
  float z = from.z - PZ_AT(PZ_CENTRE_Z), r2 = from.x * from.x + from.y * from.y, r, per, field, at;
  float steepest = PZ_AT(PZ_STEEPEST), rim = PZ_AT(PZ_FRONT_HALF), across, down, d, e, f;
  s.two = PZ_AT(PZ_SCENE_DIMENSIONS) == 3.0f;
  s.distance = PZ_SQRT(r2 + z * z);
  per = 1.0f / (s.distance > 0.0f ? s.distance : 1.0f);
  r = PZ_SQRT(r2);
  s.sine = r * per;
  s.cosine = -z * per;
  field = 6.28318530718f * pz_turn_of(s.sine, s.cosine);
  s.azimuth_x = r2 > 0.0f ? from.x / r : 0.0f;
  s.azimuth_y = r2 > 0.0f ? from.y / r : 1.0f;
  s.known = (r2 > rim * rim || z < 0.0f) && steepest * s.distance >= 1.0f && pz_finite(s.distance);
  at = s.known ? per / steepest : 0.0f;
  at = at < 1.0f ? at : 1.0f;
  across = (s.two ? field * pz_abs(s.azimuth_x) : field) / pz_last_field(PZ_P s, w, at, 0);
  down = s.two ? field * pz_abs(s.azimuth_y) / pz_last_field(PZ_P s, w, at, 1) : 0.0f;
  s.known = s.known && across <= 1.0f && down <= 1.0f;
  if (!s.known) across = down = 0.0f;
  int fields = s.two ? 6 : 12, row = fields + 1, layer = s.two ? row * row : row, i = at < 0.5f ? 0 : 1;
  int j = PZ_INT(down * PZ_FLOAT(fields)) < fields - 1 ? PZ_INT(down * PZ_FLOAT(fields)) : fields - 1;
  int k = PZ_INT(across * PZ_FLOAT(fields)) < fields - 1 ? PZ_INT(across * PZ_FLOAT(fields)) : fields - 1;
  d = 2.0f * at - PZ_FLOAT(i);
  e = s.two ? down * PZ_FLOAT(fields) - PZ_FLOAT(j) : 0.0f;
  f = across * PZ_FLOAT(fields) - PZ_FLOAT(k);
  if (!s.two) j = 0;
  for (int m = 0; m < 8; ++m) {
    s.weight[m] = (m / 4 == 1 ? d : 1.0f - d) * (m / 2 % 2 == 1 ? e : 1.0f - e) * (m % 2 == 1 ? f : 1.0f - f);
  }
  s.nodes = pz_whole(PZ_P PZ_NODES) + (w * 3 * layer + i * layer + j * row + k) * pz_whole(PZ_P PZ_NODE_SIZE);
  return s;
}
PZ_FN float pz_node_number(PZ_T pz_scene s, int k) {
  int size = pz_whole(PZ_P PZ_NODE_SIZE), row = s.two ? 7 : 0, layer = s.two ? 49 : 13;
  float sum = 0.0f;
  for (int m = 0; m < 8; ++m) {
    if (s.weight[m] != 0.0f) {
      sum += s.weight[m] * PZ_AT(s.nodes + (m / 4 * layer + m / 2 % 2 * row + m % 2) * size + k);
    }
  }
  return sum;
}
PZ_FN pz_point pz_node_point(PZ_T pz_scene s, int k) {
  return pz_xy(pz_node_number(PZ_P s, k), pz_node_number(PZ_P s, k + 1));
}
PZ_FN pz_sector pz_scene_sector(PZ_T pz_scene s, int k) {
  pz_sector own;
  own.a = pz_node_point(PZ_P s, 2 + 2 * k);
  own.b = pz_node_point(PZ_P s, 4 + 2 * k);
  own.dark_from = own.dark = 0.0f;
  if (pz_whole(PZ_P PZ_NODE_SIZE) > 132) {
    own.dark_from = pz_node_number(PZ_P s, 132 + 2 * k);
    own.dark = pz_node_number(PZ_P s, 133 + 2 * k);
  }
  return own;
}
/* A point of the plane that faces a scene point, relative to the centre; p: in the frame of the polygons. */
PZ_FN pz_vector pz_in_plane(pz_scene s, pz_point p) {
  if (s.two) {
    float x = s.azimuth_x < 0.0f ? -p.x : p.x, y = s.azimuth_y < 0.0f ? -p.y : p.y;
    p = pz_xy(s.azimuth_y * x - s.azimuth_x * y, s.azimuth_x * x + s.azimuth_y * y);
  }
  return pz_xyz(s.azimuth_y * p.x + s.azimuth_x * s.cosine * p.y, s.azimuth_y * s.cosine * p.y - s.azimuth_x * p.x,
                s.sine * p.y);
}
/* 1 / (density per area of samples in a sector): all sectors get equal numbers of samples. */
PZ_FN float pz_sector_area(pz_sector s) { return 32.0f * pz_turn(s.a, s.b) * (1.0f - s.dark); }
/* Solid angle of the ball that all rays meet, for points without a polygon. */
PZ_FN float pz_cone(PZ_T int w, float distance) {
  float sine = PZ_AT(pz_whole(PZ_P PZ_BALLS) + w) / distance;
  if (!(sine < 1.0f)) return 12.5663706144f;
  return 6.28318530718f * sine * sine / (1.0f + PZ_SQRT(1.0f - sine * sine));
}
/* True if rays of a point may reach the pupil: the point lies in front of the lens. */
PZ_FN PZ_BOOL pz_sees(PZ_T pz_vector from, int w) {
  float r2 = from.x * from.x + from.y * from.y, rim = PZ_AT(PZ_FRONT_HALF);
  int surface = pz_whole(PZ_P PZ_SURFACES);
  float u = PZ_AT(surface + 4) * from.x * from.x + PZ_AT(surface + 5) * from.y * from.y;
  if (!(PZ_AT(pz_whole(PZ_P PZ_BALLS) + w) > 0.0f && pz_finite(r2 + from.z))) return PZ_FALSE;
  return r2 > rim * rim || from.z < pz_sag_of(PZ_P surface, u).z + PZ_AT(surface);
}
/* True if points at a distance from the centre have polygons; other points sample the cone around the ball. */
PZ_FN PZ_BOOL pz_has_nodes(PZ_T int w, float distance) {
  int angles = PZ_AT(PZ_SCENE_DIMENSIONS) == 3.0f ? 2 : 1;
  return PZ_AT(pz_whole(PZ_P PZ_WIDEST) + w * 3 * angles) > 0.0f && PZ_AT(PZ_STEEPEST) * distance >= 1.0f;
}

/* A sampled connection from a scene point (lens frame, mm) through the lens to the film. */
PZ_FN pz_connection pz_connect(PZ_T pz_vector from, float u, float v, float nm) {
  pz_connection c;
  pz_light light = pz_light_of(PZ_P nm);
  pz_vector centre = pz_xyz(0.0f, 0.0f, PZ_AT(PZ_CENTRE_Z)), at;
  float to_front, sound = (u + v) * 0.0f;
  c.direction = pz_xyz(0.0f, 0.0f, 1.0f);
  c.end = pz_xyz(0.0f, 0.0f, 0.0f);
  c.distance = c.pdf = 0.0f;
  c.arrival.film = pz_xy(0.0f, 0.0f);
  c.arrival = pz_dark(c.arrival, light.nearest < 0 ? 8 : 3);
  if (light.nearest < 0 || !(sound >= 0.0f)) return c;
  pz_scene s = pz_find_scene(PZ_P from, light.nearest);
  u = pz_clamped(u);
  v = pz_clamped(v);
  if (s.known) {
    float turn = 64.0f * u, radius, area;
    int k = PZ_INT(turn) < 63 ? PZ_INT(turn) : 63;
    pz_sector own = pz_scene_sector(PZ_P s, k);
    pz_point edge = pz_on_edge(own, turn - PZ_FLOAT(k)), middle = pz_node_point(PZ_P s, 0);
    radius = PZ_SQRT(pz_squared_radius(own, v));
    middle = pz_xy(middle.x + radius * edge.x, middle.y + radius * edge.y);
    at = pz_in_plane(s, middle);
    c.direction = pz_along(pz_xyz(-s.azimuth_x * s.sine, -s.azimuth_y * s.sine, s.cosine), 1.0f / s.distance, at);
    area = pz_sector_area(own);
    radius = 1.0f / PZ_SQRT(pz_dot(c.direction, c.direction));
    c.direction = pz_xyz(c.direction.x * radius, c.direction.y * radius, c.direction.z * radius);
    c.distance = s.distance / radius;
    if (area > 0.0f) c.pdf = c.distance / s.distance * c.distance / area * c.distance;
    at = pz_along(centre, 1.0f, at);
  }
  if (!(c.pdf > 0.0f)) {
    if (!pz_sees(PZ_P from, light.nearest) || pz_has_nodes(PZ_P light.nearest, s.distance)) return c;
    float solid = pz_cone(PZ_P light.nearest, s.distance);
    float less = v * solid / 6.28318530718f; /* 1 - cosine of the angle to the centre */
    float sine = PZ_SQRT(less * (2.0f - less));
    pz_point turned = pz_circle(u);
    s.two = PZ_FALSE;
    pz_vector across = pz_in_plane(s, pz_xy(sine * turned.y, sine * turned.x));
    c.direction = pz_along(across, 1.0f - less, pz_xyz(-s.azimuth_x * s.sine, -s.azimuth_y * s.sine, s.cosine));
    c.distance = less < 1.0f ? s.distance * (1.0f - less) : 0.0f;
    at = pz_along(from, c.distance, c.direction);
    c.pdf = 1.0f / solid;
  }
  c.arrival = pz_importance(PZ_P at, c.direction, nm);
  to_front = pz_to_front(PZ_P at, pz_xyz(-c.direction.x, -c.direction.y, -c.direction.z));
  to_front = to_front < c.distance ? to_front : c.distance;
  c.distance -= to_front;
  c.end = pz_along(at, -to_front, c.direction);
  return c;
}
/* The density with which pz_connect() samples a direction at a point, 1/sr; a unit vector. */
PZ_FN float pz_pdf(PZ_T pz_vector from, pz_vector direction, float nm) {
  pz_light light = pz_light_of(PZ_P nm);
  pz_vector centre = pz_xyz(0.0f, 0.0f, PZ_AT(PZ_CENTRE_Z)), away, met, unit;
  int k = 0;
  if (light.nearest < 0 || !pz_sees(PZ_P from, light.nearest)) return 0.0f;
  pz_scene s = pz_find_scene(PZ_P from, light.nearest);
  away = pz_difference(from, centre, 1.0f);
  unit = pz_xyz(away.x / s.distance, away.y / s.distance, away.z / s.distance);
  float cosine = -pz_dot(direction, unit);
  if (!pz_has_nodes(PZ_P light.nearest, s.distance)) {
    float solid = pz_cone(PZ_P light.nearest, s.distance);
    return 1.0f - cosine <= solid / 6.28318530718f * 1.000001f ? 1.0f / solid : 0.0f;
  }
  if (!(s.known && cosine > 0.0f)) return 0.0f;
  met = pz_along(away, s.distance / cosine, direction);
  pz_point q = pz_xy(s.azimuth_y * met.x - s.azimuth_x * met.y,
                     s.cosine * (s.azimuth_x * met.x + s.azimuth_y * met.y) + s.sine * met.z);
  if (s.two) {
    q = pz_xy(s.azimuth_y * q.x + s.azimuth_x * q.y, s.azimuth_y * q.y - s.azimuth_x * q.x);
    q = pz_xy(s.azimuth_x < 0.0f ? -q.x : q.x, s.azimuth_y < 0.0f ? -q.y : q.y);
  }
  pz_point middle = pz_node_point(PZ_P s, 0);
  q = pz_xy(q.x - middle.x, q.y - middle.y);
  pz_point first = pz_node_point(PZ_P s, 2);
  for (int step = 32; step > 0; step /= 2) {
    if (pz_comes_before(first, pz_node_point(PZ_P s, 2 + 2 * (k + step)), q)) k += step;
  }
  pz_sector own = pz_scene_sector(PZ_P s, k);
  float squared = pz_squared_at(own, q);
  if (!(squared >= 0.0f && squared <= 1.0f) || pz_is_dark(own, squared)) return 0.0f;
  return s.distance / pz_sector_area(own) * s.distance / (cosine * cosine * cosine);
}

#endif /* PETZVAL_CAMERA_H */
