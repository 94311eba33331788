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

#define PZ_FORMAT 6 /* number at position 0 */
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
#define PZ_FILM_NODES 38 /* the next number is the size of a node, also for stops and scene nodes */
#define PZ_FILM_NODE_SIZE 39
#define PZ_STOPS 40
#define PZ_STOP_SIZE 41
#define PZ_TERMS 42
#define PZ_DEGREE 43
#define PZ_DOMAIN_FILM 44
#define PZ_DOMAIN_SHIFT_X 45
#define PZ_DOMAIN_RADIUS_X 46
#define PZ_DOMAIN_SHIFT_Y 47
#define PZ_DOMAIN_RADIUS_Y 48
#define PZ_REFERENCE_Z 49
#define PZ_SCENE_DIMENSIONS 50
#define PZ_CENTRE_Z 51
#define PZ_STEEPEST 52
#define PZ_FRONT_HALF 53
#define PZ_SCENE_NODES 54
#define PZ_SCENE_NODE_SIZE 55
#define PZ_WIDEST 56
#define PZ_BALLS 57
#define PZ_HEAD 58

#define PZ_SURFACE_SIZE 12

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
/* The whole part of x, from 0 to n - 1. */
PZ_FN int pz_below(int n, float x) { return x < PZ_FLOAT(n) - 1.0f ? (x > 0.0f ? PZ_INT(x) : 0) : n - 1; }
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
PZ_FN pz_vector pz_times(float s, pz_vector a) { return pz_xyz(s * a.x, s * a.y, s * a.z); }
/* a + s b */
PZ_FN pz_vector pz_along(pz_vector a, float s, pz_vector b) {
  return pz_xyz(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
PZ_FN pz_point pz_plus(pz_point a, float s, pz_point b) { return pz_xy(a.x + s * b.x, a.y + s * b.y); }

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
PZ_FN PZ_BOOL pz_on_film(PZ_T pz_point film) {
  float half_width = 0.5f * PZ_AT(PZ_FILM_WIDTH) + PZ_AT(PZ_MARGIN);
  float half_height = 0.5f * PZ_AT(PZ_FILM_HEIGHT) + PZ_AT(PZ_MARGIN);
  return pz_abs(film.x - PZ_AT(PZ_FILM_X)) <= half_width * 1.000001f &&
         pz_abs(film.y - PZ_AT(PZ_FILM_Y)) <= half_height * 1.000001f;
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
  if (!found.compiled && !(nm >= PZ_AT(PZ_SHORTEST) && nm <= PZ_AT(PZ_LONGEST))) found.nearest = -1;
  found.t = t < 1.0f ? (t > -1.0f ? t : -1.0f) : 1.0f;
  return found;
}
/* True if rays have this wavelength: polynomials have the compiled ones only. */
PZ_FN PZ_BOOL pz_has_light(PZ_T pz_light light) {
  return light.nearest >= 0 && (PZ_AT(PZ_RAYS) == 0.0f || light.compiled);
}
/* A number that depends on the wavelength: 0 scale of weights, 1 importance, 2 density of film samples, 3 area of the
 * entrance pupil, then the squared index of each space, then its change at each surface. */
PZ_FN float pz_number(PZ_T pz_light light, int k) {
  int at = pz_whole(PZ_P PZ_POWERS) + 8 * k;
  float sum = 0.0f;
  if (light.compiled) {
    return PZ_AT(pz_whole(PZ_P PZ_NUMBERS) + light.nearest * pz_whole(PZ_P PZ_NUMBER_COUNT) + k);
  }
  for (int i = 7; i >= 0; --i) sum = sum * light.t + PZ_AT(at + i);
  return sum;
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
/* True if the table has `count` times n numbers from the position on that is stored at `at`. */
PZ_FN PZ_BOOL pz_has(PZ_T int at, int count, int n) {
  int floats = pz_whole(PZ_P 1), begin = pz_count(PZ_P at, floats);
  return begin >= PZ_HEAD && pz_product(count, n, floats) <= floats - begin;
}
/* True if the table has `count` nodes of polygons. */
PZ_FN PZ_BOOL pz_has_nodes(PZ_T int at, int count) {
  int size = pz_count(PZ_P at + 1, 260);
  return (size == 132 || size == 260) && pz_has(PZ_P at, count, size);
}
/* True if `floats` numbers are a complete table of this format: no function reads outside of such a table. All other
 * functions trust their table: call this one first, for each table from a file. Tables of other formats have to be
 * exported again: `petzval export LENS --camera FILE`. */
PZ_FN PZ_BOOL pz_valid(PZ_T int floats) {
  if (floats < PZ_HEAD || floats > 16777216 || PZ_AT(0) != PZ_FLOAT(PZ_FORMAT) || PZ_AT(1) != PZ_FLOAT(floats)) {
    return PZ_FALSE;
  }
  int w = pz_count(PZ_P PZ_WAVELENGTH_COUNT, floats), surfaces = pz_count(PZ_P PZ_SURFACE_COUNT, floats);
  int rows = pz_count(PZ_P PZ_PUPIL_ROWS, floats - 1), columns = pz_count(PZ_P PZ_PUPIL_COLUMNS, floats - 1);
  int blades = pz_count(PZ_P PZ_BLADES, floats), stop_size = pz_count(PZ_P PZ_STOP_SIZE, floats);
  int numbers = pz_count(PZ_P PZ_NUMBER_COUNT, floats), film = pz_count(PZ_P PZ_PUPIL_DIMENSIONS, 2);
  int scene = pz_count(PZ_P PZ_SCENE_DIMENSIONS, 3), rays = pz_count(PZ_P PZ_RAYS, 1), nodes, widest;
  float fields = 0.0f;
  if (w < 1 || surfaces < 1 || blades < 0 || stop_size < 0 || rows < 1 || columns < 1 || numbers != 5 + 2 * surfaces ||
      film < 1 || scene < 2 || rays < 0 || pz_count(PZ_P PZ_PRIMARY, w - 1) < 0 ||
      pz_count(PZ_P PZ_MIRRORS, surfaces) < 0 || !pz_has(PZ_P PZ_WAVELENGTHS, w, 1) ||
      !pz_has(PZ_P PZ_NUMBERS, w, numbers) || !pz_has(PZ_P PZ_SURFACES, surfaces, PZ_SURFACE_SIZE) ||
      !pz_has(PZ_P PZ_EDGES, blades, 4) || !pz_has(PZ_P PZ_BALLS, w, 1) ||
      !pz_has(PZ_P PZ_WIDEST, w, 3 * (scene - 1))) {
    return PZ_FALSE;
  }
  /* Numbers between the compiled wavelengths are needed if a sample can have such a wavelength. */
  pz_light end = pz_light_of(PZ_P PZ_AT(PZ_SHORTEST));
  if ((PZ_AT(PZ_SHORTEST) < PZ_AT(PZ_LONGEST) || (end.nearest >= 0 && !end.compiled)) &&
      !pz_has(PZ_P PZ_POWERS, numbers, 8)) {
    return PZ_FALSE;
  }
  for (int i = 0; i < surfaces; ++i) {
    int at = pz_whole(PZ_P PZ_SURFACES) + i * PZ_SURFACE_SIZE + 10, list = pz_count(PZ_P at, floats);
    if (list == 0) continue;
    if (!pz_has(PZ_P at, 4, 1)) return PZ_FALSE;
    int even = pz_count(PZ_P list + 2, floats), odd = pz_count(PZ_P list + 3, floats);
    if (even < 0 || odd < 0 || !pz_has(PZ_P at, 4 + even + odd, 1)) return PZ_FALSE;
  }
  nodes = pz_product(pz_product(w, rows + 1, floats), film == 2 ? columns + 1 : 1, floats);
  if (!pz_has_nodes(PZ_P PZ_FILM_NODES, nodes) || (film == 2 && !pz_has(PZ_P PZ_HALF_WIDTHS, rows + 1, 1)) ||
      (stop_size != 0 && (blades < 1 || stop_size < (film == 2 ? 158 : 150) ||
                          !pz_has(PZ_P PZ_STOPS, nodes, stop_size) || !pz_has(PZ_P PZ_IRIS, 16 + 6 * blades, 1)))) {
    return PZ_FALSE;
  }
  if (rays == 1) {
    int degree = pz_count(PZ_P PZ_DEGREE, 99), n = (degree - 1) / 2, terms = (n + 1) * (n + 2) * (n + 3) / 6;
    terms = film == 2 ? 4 * (n + 2) * terms : 4 * terms; /* two: 8 (n + 1) (n + 2)^2 (n + 3) / 12 */
    if (degree < 1 || !pz_has(PZ_P PZ_TERMS, w, terms)) return PZ_FALSE;
  }
  /* Without nodes of scene points, all last fields are 0. */
  widest = pz_whole(PZ_P PZ_WIDEST);
  for (int i = 0; i < 3 * w * (scene - 1); ++i) {
    if (!(PZ_AT(widest + i) >= 0.0f)) return PZ_FALSE;
    fields += PZ_AT(widest + i);
  }
  nodes = fields == 0.0f ? 0 : pz_product(w, scene == 3 ? 147 : 39, floats);
  return pz_has_nodes(PZ_P PZ_SCENE_NODES, nodes);
}

/* ---- Polygons between nodes ---- */

/* A cell of a grid of nodes, and a place in the cell. Numbers of nodes are linear along each axis of the grid. */
PZ_STRUCT(pz_cell) {
  int list;       /* position in the head of the list of nodes; the size of a node follows */
  int node;       /* first node of the cell */
  int row, layer; /* nodes from one node to the next along the second and the third axis; 0: there is no such axis */
  float t, s, r;  /* fractions along the axes */
};
/* The cell at a place: its numbers along the axes, which have so many cells. w: wavelength */
PZ_FN pz_cell pz_cell_at(int list, int w, pz_vector place, int cells, int rows, int layers) {
  pz_cell c;
  int i = pz_below(cells, place.x), j = pz_below(rows, place.y), k = pz_below(layers, place.z);
  c.list = list;
  c.row = rows > 0 ? cells + 1 : 0;
  c.layer = layers > 0 ? (cells + 1) * (rows + 1) : 0;
  c.node = w * (cells + 1) * (rows + 1) * (layers + 1) + i + j * c.row + k * c.layer;
  c.t = place.x - PZ_FLOAT(i);
  c.s = place.y - PZ_FLOAT(j);
  c.r = place.z - PZ_FLOAT(k);
  return c;
}
PZ_FN float pz_linear(PZ_T int at, int step, float t) { return PZ_AT(at) + t * (PZ_AT(at + step) - PZ_AT(at)); }
PZ_FN float pz_bilinear(PZ_T pz_cell c, int at, int size) {
  float sum = pz_linear(PZ_P at, size, c.t);
  return c.row == 0 ? sum : sum + c.s * (pz_linear(PZ_P at + c.row * size, size, c.t) - sum);
}
/* Number k of the nodes. */
PZ_FN float pz_between(PZ_T pz_cell c, int k) {
  int size = pz_whole(PZ_P c.list + 1), at = pz_whole(PZ_P c.list) + c.node * size + k;
  float sum = pz_bilinear(PZ_P c, at, size);
  return c.layer == 0 ? sum : sum + c.r * (pz_bilinear(PZ_P c, at + c.layer * size, size) - sum);
}
PZ_FN pz_point pz_point_between(PZ_T pz_cell c, int k) {
  return pz_xy(pz_between(PZ_P c, k), pz_between(PZ_P c, k + 1));
}

/* A pupil is a polygon: a middle and 64 corners around it, in order from +y towards +x. Sector k is the triangle from
 * the middle to corners k and k + 1. All sectors get the same number of samples. */
PZ_STRUCT(pz_sector) {
  int k;
  pz_point a, b;         /* the corners, relative to the middle */
  float dark_from, dark; /* begin and width of the obscured interval of squared relative radii */
  float along;           /* a place on the outer edge, from a (0) to b (1) ... */
  pz_point edge;         /* ... and its point, relative to the middle */
};
PZ_FN pz_point pz_middle(PZ_T pz_cell c) { return pz_point_between(PZ_P c, 0); }
PZ_FN pz_point pz_corner(PZ_T pz_cell c, int k) { return pz_point_between(PZ_P c, 2 + 2 * k); }
/* The change of the middle from one node to the next along the first or the second axis. */
PZ_FN pz_point pz_step_of_middle(PZ_T pz_cell c, PZ_BOOL first) {
  pz_cell end = c;
  c.t = first ? 0.0f : c.t;
  c.s = first ? c.s : 0.0f;
  end.t = first ? 1.0f : c.t;
  end.s = first ? c.s : 1.0f;
  return pz_plus(pz_middle(PZ_P end), -1.0f, pz_middle(PZ_P c));
}
/* Twice the area of the triangle from the middle to a and b. */
PZ_FN float pz_turn(pz_point a, pz_point b) { return b.x * a.y - a.x * b.y; }
PZ_FN pz_sector pz_sector_of(PZ_T pz_cell c, int k) {
  pz_sector s;
  pz_point dark = pz_xy(0.0f, 0.0f);
  if (pz_whole(PZ_P c.list + 1) > 132) dark = pz_point_between(PZ_P c, 132 + 2 * k);
  s.k = k;
  s.a = s.edge = pz_corner(PZ_P c, k);
  s.b = pz_corner(PZ_P c, k + 1);
  s.dark_from = dark.x;
  s.dark = dark.y;
  s.along = 0.0f;
  return s;
}
PZ_FN pz_sector pz_with_place(pz_sector s, float along) {
  s.along = along;
  s.edge = pz_xy(s.a.x + along * (s.b.x - s.a.x), s.a.y + along * (s.b.y - s.a.y));
  return s;
}
/* The sector of a sample: `turn` is the fraction of the sectors before the point. */
PZ_FN pz_sector pz_sector_after(PZ_T pz_cell c, float turn) {
  int k = pz_below(64, 64.0f * turn);
  return pz_with_place(pz_sector_of(PZ_P c, k), 64.0f * turn - PZ_FLOAT(k));
}
/* The area that a sample of a sector represents. */
PZ_FN float pz_area_of(pz_sector s) { return 32.0f * pz_turn(s.a, s.b) * (1.0f - s.dark); }
PZ_FN float pz_squared_radius(pz_sector s, float v) {
  float within = (1.0f - s.dark) * v;
  return within < s.dark_from ? within : within + s.dark;
}
/* Inverse of pz_squared_radius(). */
PZ_FN float pz_fraction_within(pz_sector s, float squared) {
  float past = squared - s.dark > s.dark_from ? squared - s.dark : s.dark_from, left = 1.0f - s.dark;
  return (squared < s.dark_from ? squared : past) / (left > 0.0f ? left : 1.0f);
}
/* The point on the line from the middle to the place of a sector. */
PZ_FN pz_point pz_in_polygon(PZ_T pz_cell c, pz_sector s, float v) {
  return pz_plus(pz_middle(PZ_P c), PZ_SQRT(pz_squared_radius(s, v)), s.edge);
}
/* True if a corner comes before the direction of q in the order of corners, which begins at the first corner. */
PZ_FN PZ_BOOL pz_comes_before(pz_point first, pz_point corner, pz_point q) {
  PZ_BOOL half_q = pz_turn(first, q) < 0.0f, half_corner = pz_turn(first, corner) < 0.0f;
  return half_corner == half_q ? pz_turn(corner, q) >= 0.0f : !half_corner;
}
/* The sector and place in the direction of q, a point relative to the middle. */
PZ_FN pz_sector pz_sector_towards(PZ_T pz_cell c, pz_point q) {
  pz_point first = pz_corner(PZ_P c, 0);
  int k = 0;
  for (int step = 32; step > 0; step /= 2) {
    if (pz_comes_before(first, pz_corner(PZ_P c, k + step), q)) k += step;
  }
  pz_sector s = pz_sector_of(PZ_P c, k);
  float behind = pz_turn(s.a, q), sum = behind + pz_turn(q, s.b);
  return pz_with_place(s, sum > 0.0f ? behind / sum : 0.0f);
}
/* The squared relative radius of q in its sector, 0 in the middle and 1 at the edge; -1: no sample has this place. */
PZ_FN float pz_squared_at(pz_sector s, pz_point q) {
  float behind = pz_turn(s.a, q), before = pz_turn(q, s.b), whole = pz_turn(s.a, s.b), squared;
  if (!(behind >= 0.0f && before >= 0.0f && whole > 0.0f)) return -1.0f;
  squared = (behind + before) / whole * ((behind + before) / whole);
  return squared >= s.dark_from && squared < s.dark_from + s.dark ? -1.0f : squared;
}

/* ---- Pupils of film points ---- */

/* The cell of a film point. One dimension: rows over the distance from the axis, with polygons that turn with the film
 * point. Two dimensions: rows and columns of the quadrant x, y >= 0, with mirror images for the others. */
PZ_STRUCT(pz_pupil) {
  PZ_BOOL known, two; /* two: two dimensions */
  pz_cell cell;
  float sine, cosine;   /* of the direction of the film point from +y towards +x; two: signs of x and y */
  float t_by_x, t_by_y; /* two: derivatives of t by |x| and |y| */
};
PZ_FN pz_pupil pz_find_pupil(PZ_T float x, float y, int w) {
  pz_pupil p;
  float r2 = x * x + y * y, r = PZ_SQRT(r2), per_mm = PZ_AT(PZ_ROWS_PER_MM), across, up;
  int rows = pz_whole(PZ_P PZ_PUPIL_ROWS), columns = pz_whole(PZ_P PZ_PUPIL_COLUMNS);
  p.two = PZ_AT(PZ_PUPIL_DIMENSIONS) == 2.0f;
  p.known = r <= PZ_AT(PZ_REACH);
  p.t_by_x = p.t_by_y = 0.0f;
  if (!p.two) {
    p.sine = r2 > 1.0e-31f ? x / r : 0.0f;
    p.cosine = r2 > 1.0e-31f ? y / r : 1.0f;
    p.cell = pz_cell_at(PZ_FILM_NODES, w, pz_xyz(p.known ? r * per_mm : 0.0f, 0.0f, 0.0f), rows, 0, 0);
  } else {
    p.known = p.known && pz_abs(y) * per_mm <= 1.000001f * PZ_FLOAT(rows);
    up = p.known ? pz_abs(y) * per_mm : 0.0f;
    int row = pz_below(rows, up), widths = pz_whole(PZ_P PZ_HALF_WIDTHS) + row;
    float width = pz_linear(PZ_P widths, 1, up - PZ_FLOAT(row)), change = PZ_AT(widths + 1) - PZ_AT(widths);
    p.known = p.known && pz_abs(x) <= 1.000001f * width;
    p.t_by_x = width > 0.0f ? PZ_FLOAT(columns) / width : 0.0f;
    across = p.known ? pz_abs(x) / (width > 0.0f ? width : 1.0f) * PZ_FLOAT(columns) : 0.0f;
    p.t_by_y = width > 0.0f ? -across * change * per_mm / width : 0.0f;
    p.sine = x < 0.0f ? -1.0f : 1.0f;
    p.cosine = y < 0.0f ? -1.0f : 1.0f;
    p.cell = pz_cell_at(PZ_FILM_NODES, w, pz_xyz(across, up, 0.0f), columns, rows, 0);
  }
  return p;
}
/* A point in the frame of the film from the frame of the grid, and back. */
PZ_FN pz_point pz_to_film(pz_pupil p, pz_point q) {
  if (p.two) return pz_xy(p.sine * q.x, p.cosine * q.y);
  return pz_xy(p.cosine * q.x + p.sine * q.y, p.cosine * q.y - p.sine * q.x);
}
PZ_FN pz_point pz_to_grid(pz_pupil p, pz_point q) {
  if (p.two) return pz_xy(p.sine * q.x, p.cosine * q.y);
  return pz_xy(p.cosine * q.x - p.sine * q.y, p.sine * q.x + p.cosine * q.y);
}

/* ---- Iris ---- */

/* Point (u, v) of an iris with blades, in semi-diameters of the stop: u counts sectors from the first corner, and v is
 * the fraction of the area nearer to the centre. */
PZ_FN pz_point pz_iris_point(PZ_T float u, float v) {
  int blades = pz_whole(PZ_P PZ_BLADES), list = pz_whole(PZ_P PZ_IRIS), k = pz_below(blades, u * PZ_FLOAT(blades));
  float q = 2.0f * (u * PZ_FLOAT(blades) - PZ_FLOAT(k)) - 1.0f, t = 2.0f * q * q - 1.0f, across = 0.0f, along = 0.0f;
  for (int i = 7; i >= 0; --i) {
    across = across * t + PZ_AT(list + i);
    along = along * t + PZ_AT(list + 8 + i);
  }
  float sine = PZ_AT(list + 16 + 2 * k), cosine = PZ_AT(list + 17 + 2 * k), radius = PZ_SQRT(v);
  across *= q;
  return pz_xy(radius * (along * sine + across * cosine), radius * (along * cosine - across * sine));
}
/* Distance of a point inside an edge of the iris. edge: its position in the table, in mm or in semi-diameters */
PZ_FN float pz_inside(PZ_T int edge, pz_point p) {
  float bend = PZ_AT(edge + 2) * (p.x * p.x + p.y * p.y);
  return PZ_AT(edge + 3) - (p.x * PZ_AT(edge) + p.y * PZ_AT(edge + 1) + bend);
}
/* True if a point lies inside all edges of a list. */
PZ_FN PZ_BOOL pz_within(PZ_T int list, pz_point p) {
  int blades = pz_whole(PZ_P PZ_BLADES);
  for (int i = 0; i < blades; ++i) {
    if (pz_inside(PZ_P list + 4 * i, p) < 0.0f) return PZ_FALSE;
  }
  return PZ_TRUE;
}
PZ_FN int pz_unit_edges(PZ_T int blades) { return pz_whole(PZ_P PZ_IRIS) + 16 + 2 * blades; }

/* The stop of the pupil: numbers of the same cell. */
PZ_FN pz_cell pz_stop_of(pz_pupil p) {
  p.cell.list = PZ_STOPS;
  return p.cell;
}
/* True if samples are points of the iris, false if they are points of the polygon inside the iris. */
PZ_FN PZ_BOOL pz_samples_iris(PZ_T pz_pupil p) {
  int size = pz_whole(PZ_P PZ_STOP_SIZE);
  return size > 0 && PZ_AT(pz_whole(PZ_P PZ_STOPS) + p.cell.node * size + (p.two ? 26 : 18)) > 0.0f;
}
/* The image of a stop point in the pupil plane, in the frame of the grid. x and y: value, derivatives by the stop's x
 * and y */
PZ_STRUCT(pz_seen) { pz_vector x, y; };
/* Polynomials of the stop point up to the third power: ten terms from number k on. */
PZ_FN pz_vector pz_cubic(PZ_T pz_cell stop, int k, float x, float y) {
  float a[10], xx = x * x, yy = y * y, by_x, by_y;
  for (int i = 0; i < 10; ++i) a[i] = pz_between(PZ_P stop, k + i);
  by_x = a[1] + 2.0f * (a[3] * x + a[7] * x * y) + a[4] * y + 3.0f * a[6] * xx + a[8] * yy;
  by_y = a[2] + 2.0f * (a[5] * y + a[8] * x * y) + a[4] * x + 3.0f * a[9] * yy + a[7] * xx;
  return pz_xyz(
      a[0] + x * (a[1] + a[3] * x + a[4] * y + a[6] * xx + a[8] * yy) + y * (a[2] + a[5] * y + a[7] * xx + a[9] * yy),
      by_x, by_y);
}
PZ_FN pz_seen pz_see(PZ_T pz_pupil p, float x, float y) {
  pz_seen seen;
  pz_cell stop = pz_stop_of(p);
  if (p.two) {
    seen.x = pz_cubic(PZ_P stop, 1, x, y);
    seen.y = pz_cubic(PZ_P stop, 11, x, y);
    return seen;
  }
  float a[15], xx = x * x, yy = y * y, r = xx + yy, r2 = r * r, across, by_x, by_y;
  for (int i = 0; i < 15; ++i) a[i] = pz_between(PZ_P stop, 1 + i);
  across = a[9] + y * (a[10] + a[13] * r) + a[11] * xx + a[12] * yy + a[14] * r2;
  by_x = 2.0f * x * (a[11] + a[13] * y + 2.0f * a[14] * r);
  by_y = a[10] + 2.0f * a[12] * y + a[13] * (r + 2.0f * yy) + 4.0f * a[14] * r * y;
  seen.x = pz_xyz(x * across, across + x * by_x, x * by_y);
  seen.y.x = a[0] + y * (a[1] + a[3] * y + a[4] * xx + a[5] * yy + a[8] * r2) + a[2] * xx + a[6] * r2 + a[7] * r * yy;
  seen.y.y = 2.0f * x * (a[2] + a[4] * y + 2.0f * a[6] * r + a[7] * yy + 2.0f * a[8] * y * r);
  seen.y.z = a[1] + 2.0f * y * (a[3] + 2.0f * a[6] * r + a[7] * (r + yy)) + a[4] * xx + 3.0f * a[5] * yy +
             a[8] * (r2 + 4.0f * yy * r);
  return seen;
}
PZ_FN float pz_determinant(pz_seen s) { return s.x.y * s.y.z - s.x.z * s.y.y; }
/* A step of Newton's method towards the stop point whose image is p. */
PZ_FN pz_point pz_newton_step(pz_seen s, pz_point p) {
  float per = 1.0f / pz_determinant(s), x = p.x - s.x.x, y = p.y - s.y.x;
  return pz_xy((s.y.z * x - s.x.z * y) * per, (s.x.y * y - s.y.y * x) * per);
}
/* The area that a sample of the iris represents. */
PZ_FN float pz_iris_area(PZ_T pz_seen s, float scale) {
  return PZ_AT(PZ_IRIS_AREA) * scale * scale * pz_abs(pz_determinant(s));
}

/* The interval of a line from a (0) to a + d (1) inside all edges of the iris, as from = x, to = y. */
PZ_FN pz_point pz_cut(PZ_T pz_point a, pz_point d) {
  int blades = pz_whole(PZ_P PZ_BLADES), edge = pz_unit_edges(PZ_P blades);
  float from = 0.0f, to = 1.0f;
  for (int k = 0; k < blades; ++k, edge += 4) {
    float bend = PZ_AT(edge + 2), outside = -pz_inside(PZ_P edge, a), first, last = 2.0f, beyond = 2.0f;
    float square = bend * (d.x * d.x + d.y * d.y), slope = 2.0f * bend * (a.x * d.x + a.y * d.y);
    slope += PZ_AT(edge) * d.x + PZ_AT(edge + 1) * d.y;
    float inner = slope * slope - 4.0f * square * outside;
    float root = PZ_SQRT(inner > 0.0f ? inner : 0.0f), leaving = root + slope, entering = root - slope;
    if (inner >= 0.0f && outside * leaving < 0.0f) last = -2.0f * outside / leaving;
    if (inner >= 0.0f && entering > 0.0f) beyond = 2.0f * outside / entering;
    first = outside > 0.0f ? beyond : 0.0f;
    to = last < to ? last : to;
    from = first > from ? first : from;
  }
  return pz_xy(from, to);
}
/* The interval of squared relative radii inside the iris, on the line from the middle of a pupil to a place of its
 * edge. The line is straight in the pupil and nearly straight at the stop: a second pass corrects it at the clipped
 * end. */
PZ_FN pz_point pz_clip(PZ_T pz_pupil p, pz_sector s) {
  if (PZ_AT(PZ_STOP_SIZE) == 0.0f) return pz_xy(0.0f, 1.0f);
  pz_cell stop = pz_stop_of(p);
  int at = p.two ? 24 : 16, corner = at + 4 + 2 * s.k;
  float scale = pz_between(PZ_P stop, 0), per = 1.0f / scale, look;
  pz_point begin = pz_point_between(PZ_P stop, at), a = pz_point_between(PZ_P stop, corner);
  pz_point b = pz_point_between(PZ_P stop, corner + 2), path, interval, straight, in_pupil, off;
  path = pz_xy(a.x + s.along * (b.x - a.x) - begin.x, a.y + s.along * (b.y - a.y) - begin.y);
  begin = pz_to_film(p, pz_xy(per * begin.x, per * begin.y));
  path = pz_to_film(p, pz_xy(per * path.x, per * path.y));
  interval = pz_cut(PZ_P begin, path);
  look = interval.y > 0.25f ? interval.y : 0.25f;
  straight = pz_to_grid(p, pz_plus(begin, look, path));
  in_pupil = pz_plus(pz_middle(PZ_P p.cell), look, s.edge);
  off = pz_newton_step(pz_see(PZ_P p, scale * straight.x, scale * straight.y), in_pupil);
  interval = pz_cut(PZ_P begin, pz_plus(path, per / look, pz_to_film(p, off)));
  interval.x = interval.x < interval.y ? interval.x : interval.y;
  return pz_xy(interval.x * interval.x, interval.y * interval.y);
}

/* A sample of a pupil: position in the pupil plane and area; area 0: there is no pupil. */
PZ_STRUCT(pz_pupil_sample) {
  pz_point at;
  float area;
};
PZ_FN pz_pupil_sample pz_sample_pupil(PZ_T pz_pupil p, float u, float v) {
  pz_pupil_sample result;
  result.at = pz_xy(0.0f, 0.0f);
  result.area = 0.0f;
  if (!p.known) return result;
  u = pz_clamped(u);
  v = pz_clamped(v);
  if (pz_samples_iris(PZ_P p)) {
    float scale = pz_between(PZ_P pz_stop_of(p), 0);
    pz_point stop = pz_to_grid(p, pz_iris_point(PZ_P u, v));
    pz_seen seen = pz_see(PZ_P p, scale * stop.x, scale * stop.y);
    result.at = pz_to_film(p, pz_xy(seen.x.x, seen.y.x));
    result.area = pz_iris_area(PZ_P seen, scale);
    return result;
  }
  /* u starts at +y of the film; corners start at +y of the grid. */
  if (p.two) {
    u = 0.25f * (1.0f - p.cosine) + p.cosine * (0.5f * (1.0f - p.sine) + p.sine * u);
  } else {
    u -= pz_turn_of(p.sine, p.cosine);
  }
  pz_sector s = pz_sector_after(PZ_P p.cell, pz_clamped(pz_fraction(u)));
  pz_point interval = pz_clip(PZ_P p, s);
  float first = pz_fraction_within(s, interval.x), fraction = pz_fraction_within(s, interval.y) - first;
  result.at = pz_to_film(p, pz_in_polygon(PZ_P p.cell, s, first + v * fraction));
  result.area = pz_area_of(s) * fraction;
  return result;
}
/* The area of a sample of the iris at a point of the pupil plane, in the frame of the grid. */
PZ_FN float pz_iris_area_at(PZ_T pz_pupil p, pz_point q) {
  float scale = pz_between(PZ_P pz_stop_of(p), 0), step2 = 0.0f, r2 = 0.0f;
  pz_point stop = pz_xy(0.0f, 0.0f), unit;
  for (int i = 0; i < 4; ++i) {
    pz_point by = pz_newton_step(pz_see(PZ_P p, stop.x, stop.y), q);
    step2 = by.x * by.x + by.y * by.y;
    stop = pz_plus(stop, 1.0f, by);
    r2 = stop.x * stop.x + stop.y * stop.y; /* stays near the rim: outside, the polynomials are not fitted */
    if (r2 > 2.25f) stop = pz_xy(stop.x * 1.5f / PZ_SQRT(r2), stop.y * 1.5f / PZ_SQRT(r2));
  }
  unit = pz_to_film(p, pz_xy(stop.x / scale, stop.y / scale));
  if (!(step2 < 1.0e-6f && unit.x * unit.x + unit.y * unit.y <= 1.000001f)) return 0.0f;
  if (!pz_within(PZ_P pz_unit_edges(PZ_P pz_whole(PZ_P PZ_BLADES)), unit)) return 0.0f;
  return pz_iris_area(PZ_P pz_see(PZ_P p, stop.x, stop.y), scale);
}
/* The area that the sample at a point of the pupil plane represents; 0: no sample has this position. */
PZ_FN float pz_area_at(PZ_T pz_pupil p, pz_point q) {
  if (!p.known) return 0.0f;
  q = pz_to_grid(p, q);
  if (pz_samples_iris(PZ_P p)) return pz_iris_area_at(PZ_P p, q);
  q = pz_plus(q, -1.0f, pz_middle(PZ_P p.cell));
  pz_sector s = pz_sector_towards(PZ_P p.cell, q);
  pz_point interval = pz_clip(PZ_P p, s);
  float squared = pz_squared_at(s, q);
  if (!(squared >= interval.x && squared <= interval.y)) return 0.0f;
  return pz_area_of(s) * (pz_fraction_within(s, interval.y) - pz_fraction_within(s, interval.x));
}

/* ---- Rays through the surfaces ---- */

/* Rays on their way. z counts from the vertex of the surface, along the direction of travel; p is the direction times
 * the index of the medium, so that refraction needs no division. ray[1] and ray[2] are derivatives of ray[0] by film x
 * and y. */
PZ_STRUCT(pz_follower) { pz_vector at, p; };
PZ_STRUCT(pz_beam) {
  pz_follower ray[3];
  float sense; /* 1: light travels towards +z */
  int fate;
};
/* A polynomial without a constant term, and its derivatives: n coefficients from a position on. */
PZ_FN pz_vector pz_series(PZ_T int at, int n, float v) {
  pz_vector p = pz_xyz(0.0f, 0.0f, 0.0f);
  for (int i = n - 1; i >= -1; --i) {
    p = pz_xyz(p.x * v + (i >= 0 ? PZ_AT(at + i) : 0.0f), p.y * v + p.x, p.z * v + 2.0f * p.y);
  }
  return p;
}
/* Sag z of a surface at a squared height u: z, slope = 2 dz/du, bend = d slope / du. */
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
    pz_vector p = pz_series(PZ_P asphere + 4, even, v), q = pz_series(PZ_P asphere + 4 + even, odd, v);
    s.z += p.x + rho * q.x;
    s.slope += 2.0f * (p.y + (rho > 1.0e-9f ? rho * q.y + 0.5f * q.x / rho : 0.0f)) / height2;
    if (rho > 1.0e-9f) p.z += rho * q.z + q.y / rho - 0.25f * q.x / (rho * v);
    s.bend += 2.0f * p.z / (height2 * height2);
  }
  return s;
}

/* A point of a surface, where N = (-g.x, -g.y, g.z) is half the gradient of its equation. */
PZ_STRUCT(pz_contact) {
  pz_vector at, p; /* the point; p in front of the surface */
  pz_vector g;
  pz_vector c;                     /* N changes by -(c.x dx, c.y dy, c.z dz) ... */
  float twist, ax, ay;             /* ... - twist (ax x, ay y, 0) (ax x dx + ay y dy) */
  float way, nn, xi, xo, gamma, k; /* way in units of p, N N, p N, p' N, (p' N - p N) / nn, n'^2 - n^2 */
};
/* The derivative of a ray behind a surface by the chain rule. */
PZ_FN pz_follower pz_follow(pz_follower d, pz_contact s) {
  pz_vector n, normal = pz_xyz(-s.g.x, -s.g.y, s.g.z);
  float h, xi, gamma;
  d.at = pz_along(d.at, s.way, d.p);
  d.at = pz_along(d.at, -pz_dot(normal, d.at) / s.xi, s.p); /* the point stays on the surface */
  h = s.twist * (s.ax * s.at.x * d.at.x + s.ay * s.at.y * d.at.y);
  n = pz_xyz(s.c.x * d.at.x + s.ax * s.at.x * h, s.c.y * d.at.y + s.ay * s.at.y * h, s.c.z * d.at.z);
  xi = pz_dot(normal, d.p) - pz_dot(n, s.p);
  gamma = -s.gamma / s.xo * xi - 2.0f * (0.5f * s.k / s.xo - s.gamma) / s.nn * pz_dot(normal, n);
  d.p = pz_along(pz_along(d.p, gamma, normal), -s.gamma, n);
  return d;
}
/* Between the frame of the lens and of the way through it, or at a mirror. rays: 1, or 3 with derivatives, here and in
 * the functions below, where compilers make a version for each; n: index, or its inverse */
PZ_FN pz_beam pz_turned(pz_beam b, int rays, float sense, float n) {
  for (int i = 0; i < rays; ++i) {
    b.ray[i].at.z *= sense;
    b.ray[i].p = pz_xyz(n * b.ray[i].p.x, n * b.ray[i].p.y, sense * n * b.ray[i].p.z);
  }
  return b;
}
PZ_FN pz_beam pz_stopped(pz_beam b, int fate) {
  b.fate = fate;
  return b;
}
/* One surface. n2: squared index in front of it; k: change of the squared index; clips: apertures clip the ray. */
PZ_FN pz_beam pz_pass(PZ_T pz_beam b, int surface, float n2, float k, PZ_BOOL clips, int rays) {
  float c = b.sense * PZ_AT(surface + 2), e = PZ_AT(surface + 3);
  float ax = PZ_AT(surface + 4), ay = PZ_AT(surface + 5), rim2 = PZ_AT(surface + 6), r2, d;
  float quadratic, facing, free, shift;
  int asphere = pz_whole(PZ_P surface + 10);
  PZ_BOOL mirror = PZ_AT(surface + 8) != 0.0f, sphere = asphere == 0 && e == 1.0f && ax * ay == 1.0f, found = PZ_TRUE;
  pz_vector at = b.ray[0].at, p = b.ray[0].p;
  pz_contact s;
  /* Near the vertex the quadratic loses no digits: go to its plane, or to the nearest point if the ray is steep. */
  if (p.z * pz_abs(p.z) > 0.09f * n2) {
    shift = -at.z / p.z;
    at = pz_xyz(at.x + shift * p.x, at.y + shift * p.y, 0.0f);
  } else {
    shift = -(ax * at.x * p.x + ay * at.y * p.y + at.z * p.z) / (ax * p.x * p.x + ay * p.y * p.y + p.z * p.z);
    at = pz_along(at, shift, p);
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
    s.way = facing >= 0.0f ? free / (facing + root) : (facing - root) / quadratic;
    at = pz_along(at, s.way, p);
    s.g = pz_xyz(c * ax * at.x, c * ay * at.y, 1.0f - c * e * at.z);
    s.c = pz_xyz(c * ax, c * ay, c * e);
    s.xi = root;
    found = found && s.g.z > 0.0f && pz_finite(s.way);
  } else {
    float size = PZ_AT(asphere) + ax * pz_abs(at.x) + ay * pz_abs(at.y) + pz_abs(at.z), u;
    pz_sag sag;
    PZ_BOOL settled = PZ_FALSE;
    s.way = d > 0.0f && facing > 0.0f ? free / (facing + root) : 0.0f;
    for (int i = 0; i < 12 && !settled; ++i) { /* Newton's method */
      pz_vector on = pz_along(at, s.way, p);
      sag = pz_sag_of(PZ_P surface, ax * on.x * on.x + ay * on.y * on.y);
      float above = on.z - b.sense * sag.z;
      s.xi = p.z - b.sense * sag.slope * (ax * on.x * p.x + ay * on.y * p.y);
      settled = sag.defined && pz_abs(above) <= 2.4e-7f * (size + pz_abs(s.way));
      s.way -= above / s.xi;
    }
    at = pz_along(at, s.way, p);
    u = ax * at.x * at.x + ay * at.y * at.y;
    s.g = pz_xyz(b.sense * sag.slope * ax * at.x, b.sense * sag.slope * ay * at.y, 1.0f);
    s.c = pz_xyz(b.sense * sag.slope * ax, b.sense * sag.slope * ay, 0.0f);
    s.twist = 2.0f * b.sense * sag.bend;
    if (clips && !(u <= PZ_AT(asphere + 1))) return pz_stopped(b, 3);
    found = settled && s.xi > 0.0f;
  }
  b.ray[0].at = at;
  r2 = at.x * at.x + at.y * at.y;
  if (!found) return pz_stopped(b, 1);
  if (clips && !(r2 <= rim2 && r2 >= PZ_AT(surface + 7))) return pz_stopped(b, 3);
  if (clips && PZ_AT(surface + 9) != 0.0f) {
    if (!pz_within(PZ_P pz_whole(PZ_P PZ_EDGES), pz_xy(at.x, at.y))) return pz_stopped(b, 3);
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
  b.ray[0].p = pz_xyz(p.x - s.gamma * s.g.x, p.y - s.gamma * s.g.y, p.z + s.gamma * s.g.z);
  s.at = at;
  s.way += shift;
  for (int i = 1; i < rays; ++i) b.ray[i] = pz_follow(b.ray[i], s);
  if (mirror) b = pz_turned(b, rays, -1.0f, 1.0f);
  if (mirror) b.sense = -b.sense;
  return b;
}

/* Traces a ray in the lens frame through all surfaces, to the film or to the scene. */
PZ_FN pz_beam pz_trace(PZ_T pz_beam b, pz_light light, PZ_BOOL to_film, PZ_BOOL clips, int rays) {
  int count = pz_whole(PZ_P PZ_SURFACE_COUNT), list = pz_whole(PZ_P PZ_SURFACES);
  int surface = list + (to_film ? 0 : count - 1) * PZ_SURFACE_SIZE;
  float n2 = pz_number(PZ_P light, to_film ? 4 : 4 + count), length;
  b.sense = to_film || pz_whole(PZ_P PZ_MIRRORS) % 2 != 0 ? 1.0f : -1.0f;
  b.fate = 0;
  b.ray[0].at.z -= PZ_AT(surface);
  b = pz_turned(b, rays, b.sense, PZ_SQRT(n2));
  for (int j = 0; j < count; ++j) {
    int i = to_film ? j : count - 1 - j;
    float k = pz_number(PZ_P light, 5 + count + i);
    surface = list + i * PZ_SURFACE_SIZE;
    if (j > 0) b.ray[0].at.z -= b.sense * (to_film ? PZ_AT(surface - PZ_SURFACE_SIZE + 1) : -PZ_AT(surface + 1));
    if (j % 4 == 0) b.ray[0].p = pz_times(1.5f - 0.5f * pz_dot(b.ray[0].p, b.ray[0].p) / n2, b.ray[0].p);
    b = pz_pass(PZ_P b, surface, n2, to_film ? k : -k, clips, rays);
    if (b.fate != 0) return b;
    n2 = pz_number(PZ_P light, to_film ? 5 + i : 4 + i);
  }
  length = pz_dot(b.ray[0].p, b.ray[0].p) / n2;
  if (!(pz_abs(length - 1.0f) < 1.2e-5f)) b.fate = 1;
  b = pz_turned(b, rays, b.sense, 1.0f / PZ_SQRT(n2));
  b.ray[0].p = pz_times(1.5f - 0.5f * length, b.ray[0].p);
  b.ray[0].at.z += PZ_AT(surface);
  return b;
}

/* ---- Rays by polynomials ---- */

/* Film and pupil point, scaled by the domain: film x, y, pupil x, y. Or a ray in object space as two vectors that turn
 * with it about the axis: the stereographic projection of the direction, and the foot of the perpendicular from the
 * reference point. Each is A f + B p, with f and p the film and pupil point, scaled, and polynomials A and B. */
PZ_STRUCT(pz_four) { float v[4]; };
PZ_FN pz_four pz_in_domain(PZ_T pz_point film, pz_point pupil) {
  pz_four x;
  x.v[0] = film.x / PZ_AT(PZ_DOMAIN_FILM);
  x.v[1] = film.y / PZ_AT(PZ_DOMAIN_FILM);
  x.v[2] = (pupil.x - PZ_AT(PZ_DOMAIN_SHIFT_X) * film.x) / PZ_AT(PZ_DOMAIN_RADIUS_X);
  x.v[3] = (pupil.y - PZ_AT(PZ_DOMAIN_SHIFT_Y) * film.y) / PZ_AT(PZ_DOMAIN_RADIUS_Y);
  return x;
}
PZ_FN int pz_fate_in_domain(pz_four x) {
  float film2 = x.v[0] * x.v[0] + x.v[1] * x.v[1], pupil2 = x.v[2] * x.v[2] + x.v[3] * x.v[3];
  return film2 <= 1.00001f && pupil2 <= 1.00001f ? 0 : 5;
}
PZ_FN pz_four pz_sums(PZ_T int w, pz_four x) {
  int n = (pz_whole(PZ_P PZ_DEGREE) - 1) / 2, list = pz_whole(PZ_P PZ_TERMS), at;
  int of_three = (n + 1) * (n + 2) * (n + 3) / 6, of_four = (n + 1) * (n + 2) * (n + 3) * (n + 2) / 12;
  PZ_BOOL two = PZ_AT(PZ_PUPIL_DIMENSIONS) == 2.0f;
  int terms = two ? of_four : of_three, stride = two ? 2 * terms : terms;
  pz_four sums;
  float a[4];
  /* Along x and y: f and p along this axis, g and q along the other. Lenses of revolution have the same polynomials
   * of f f, f p and p p for both axes. */
  for (int axis = 0; axis < 2; ++axis) {
    float f = x.v[axis], g = x.v[1 - axis], p = x.v[2 + axis], q = x.v[3 - axis];
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
    sums.v[axis] = a[0] * f + a[1] * p;
    sums.v[2 + axis] = a[2] * f + a[3] * p;
  }
  return sums;
}
PZ_FN pz_beam pz_by_polynomial(PZ_T int w, pz_point film, pz_point pupil) {
  pz_beam b;
  pz_four x = pz_in_domain(PZ_P film, pupil), c = pz_sums(PZ_P w, x);
  float square = c.v[0] * c.v[0] + c.v[1] * c.v[1], twice = 2.0f / (square + 1.0f);
  float along = twice * (c.v[0] * c.v[2] + c.v[1] * c.v[3]);
  b.fate = pz_fate_in_domain(x);
  b.ray[0].at = pz_xyz(c.v[2] - c.v[0] * along, c.v[3] - c.v[1] * along, along + PZ_AT(PZ_REFERENCE_Z));
  b.ray[0].p = pz_xyz(twice * c.v[0], twice * c.v[1], twice * (square - 1.0f) / 2.0f);
  return b;
}

/* ---- From the film to the scene ---- */

/* Distance along a ray towards the scene to the front of the lens: a sphere through the front vertex, or a plane. */
PZ_FN float pz_to_front(PZ_T pz_vector o, pz_vector d) {
  float c = PZ_AT(PZ_FRONT_CURVATURE), along, b, square;
  o.z -= PZ_AT(PZ_FRONT_Z);
  along = pz_dot(o, d);
  b = d.z - c * along;
  square = b * b - c * (c * pz_dot(o, o) - 2.0f * o.z);
  if (square > 0.0f && (b < 0.0f || c != 0.0f)) {
    float root = PZ_SQRT(square);
    return b < 0.0f ? (c * pz_dot(o, o) - 2.0f * o.z) / (b - root) : (b + root) / c;
  }
  return d.z < 0.0f ? -o.z / d.z : -along;
}
/* A film point and a point of its pupil: before the ray is known. */
PZ_STRUCT(pz_start) {
  pz_light light;
  pz_point film;
  pz_pupil pupil;
  pz_pupil_sample to;
  int fate;
};
PZ_FN pz_start pz_start_of(PZ_T float x, float y, float u, float v, float nm) {
  pz_start s;
  float sound = (u + v) * 0.0f; /* NaN unless u and v are finite */
  s.light = pz_light_of(PZ_P nm);
  s.film = pz_xy(x, y);
  s.fate = !pz_on_film(PZ_P s.film) ? 6 : !(sound >= 0.0f) ? 3 : pz_has_light(PZ_P s.light) ? 0 : 8;
  if (s.fate != 0) return s;
  s.pupil = pz_find_pupil(PZ_P x, y, s.light.nearest);
  s.to = pz_sample_pupil(PZ_P s.pupil, u, v);
  s.fate = s.to.area > 0.0f ? 0 : 3;
  return s;
}
/* The derivatives of the middle of a pupil by the film point: of x and y, as y and z of two vectors. */
PZ_FN pz_seen pz_motion(PZ_T pz_start s) {
  pz_pupil p = s.pupil;
  pz_seen by;
  float per_mm = PZ_AT(PZ_ROWS_PER_MM), sine = p.sine, cosine = p.cosine, sign = sine * cosine;
  pz_point by_t = pz_step_of_middle(PZ_P p.cell, PZ_TRUE), by_s;
  if (!p.two) {
    float r = PZ_SQRT(s.film.x * s.film.x + s.film.y * s.film.y), along = by_t.y * per_mm;
    float across = r * per_mm >= 1.0f ? pz_middle(PZ_P p.cell).y / r : along;
    by.x = pz_xyz(0.0f, along * sine * sine + across * cosine * cosine, (along - across) * sign);
    by.y = pz_xyz(0.0f, by.x.z, along * cosine * cosine + across * sine * sine);
  } else {
    by_s = pz_step_of_middle(PZ_P p.cell, PZ_FALSE);
    by.x = pz_xyz(0.0f, by_t.x * p.t_by_x, sign * (by_s.x * per_mm + by_t.x * p.t_by_y));
    by.y = pz_xyz(0.0f, sign * by_t.y * p.t_by_x, by_s.y * per_mm + by_t.y * p.t_by_y);
  }
  return by;
}
/* The start of a ray moves with a film point by df, and so its pupil point by dp: the derivative of the ray. Rays by
 * polynomials: by central differences; others: of pupil - film, less its part along the ray p. */
PZ_FN pz_follower pz_moved(PZ_T pz_start s, pz_vector p, pz_point df, pz_point dp) {
  pz_follower by;
  if (PZ_AT(PZ_RAYS) == 1.0f) {
    float h = 0.004f * PZ_AT(PZ_DOMAIN_FILM);
    int w = s.light.nearest;
    pz_beam more = pz_by_polynomial(PZ_P w, pz_plus(s.film, h, df), pz_plus(s.to.at, h, dp));
    pz_beam less = pz_by_polynomial(PZ_P w, pz_plus(s.film, -h, df), pz_plus(s.to.at, -h, dp));
    by.at = pz_times(0.5f / h, pz_along(more.ray[0].at, -1.0f, less.ray[0].at));
    by.p = pz_times(0.5f / h, pz_along(more.ray[0].p, -1.0f, less.ray[0].p));
  } else {
    float per = p.z / (PZ_AT(PZ_PUPIL_Z) - PZ_AT(PZ_FILM_Z));
    by.at = pz_xyz(dp.x, dp.y, 0.0f);
    by.p = pz_xyz((dp.x - df.x) * per, (dp.y - df.y) * per, 0.0f);
    by.p = pz_along(by.p, -pz_dot(by.p, p), p);
  }
  return by;
}
/* The ray of a start, in the plane where its model ends. rays: 1, or 3 with derivatives */
PZ_FN pz_beam pz_leave(PZ_T pz_start s, int rays) {
  pz_beam b;
  PZ_BOOL exact = PZ_AT(PZ_RAYS) == 0.0f;
  if (exact) {
    pz_vector path = pz_xyz(s.to.at.x - s.film.x, s.to.at.y - s.film.y, PZ_AT(PZ_PUPIL_Z) - PZ_AT(PZ_FILM_Z));
    /* Light leaves the lens towards -z, or towards +z after an odd number of mirrors. */
    PZ_BOOL ahead = (path.z < 0.0f) == (pz_whole(PZ_P PZ_MIRRORS) % 2 == 0);
    b.ray[0].at = pz_xyz(s.to.at.x, s.to.at.y, PZ_AT(PZ_PUPIL_Z));
    b.ray[0].p = pz_times((ahead ? 1.0f : -1.0f) / PZ_SQRT(pz_dot(path, path)), path);
  } else {
    b = pz_by_polynomial(PZ_P s.light.nearest, s.film, s.to.at);
  }
  if (rays > 1) {
    pz_seen pupil = pz_motion(PZ_P s);
    b.ray[1] = pz_moved(PZ_P s, b.ray[0].p, pz_xy(1.0f, 0.0f), pz_xy(pupil.x.y, pupil.y.y));
    b.ray[2] = pz_moved(PZ_P s, b.ray[0].p, pz_xy(0.0f, 1.0f), pz_xy(pupil.x.z, pupil.y.z));
  }
  if (exact) b = pz_trace(PZ_P b, s.light, PZ_FALSE, PZ_TRUE, rays);
  return b;
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
/* The camera ray of a start and its beam: with weight, and from the front of the lens. */
PZ_FN pz_ray pz_ray_of(PZ_T pz_start s, pz_beam b) {
  pz_ray ray = pz_lost(b.fate);
  float depth = PZ_AT(PZ_PUPIL_Z) - PZ_AT(PZ_FILM_Z), x = s.to.at.x - s.film.x, y = s.to.at.y - s.film.y;
  float factor = depth / (x * x + y * y + depth * depth);
  ray.pdf_pupil = 1.0f / s.to.area;
  if (b.fate != 0) return ray;
  ray.origin = b.ray[0].at;
  ray.direction = b.ray[0].p;
  ray.weight = pz_number(PZ_P s.light, 0) * s.to.area * factor * factor;
  if (PZ_AT(PZ_RAYS) == 1.0f || PZ_AT(PZ_FRONT_FIRST) == 0.0f) {
    ray.origin = pz_along(ray.origin, pz_to_front(PZ_P ray.origin, ray.direction), ray.direction);
  }
  return ray;
}
/* A camera ray from a film point (mm), a pupil sample (u, v from 0 to 1) and a wavelength (nm). */
PZ_FN pz_ray pz_sample(PZ_T float film_x, float film_y, float u, float v, float nm) {
  pz_start s = pz_start_of(PZ_P film_x, film_y, u, v, nm);
  if (s.fate != 0) return pz_lost(s.fate);
  return pz_ray_of(PZ_P s, pz_leave(PZ_P s, 1));
}
/* The same ray with its derivatives by the film point, for texture filters. The offset of the pupil point from the
 * middle of the pupil is constant. */
PZ_FN pz_ray_differential pz_sample_differential(PZ_T float film_x, float film_y, float u, float v, float nm) {
  pz_start s = pz_start_of(PZ_P film_x, film_y, u, v, nm);
  pz_ray_differential result;
  result.ray = pz_lost(s.fate);
  result.origin_by_x = result.direction_by_x = result.origin_by_y = result.direction_by_y = pz_xyz(0.0f, 0.0f, 0.0f);
  if (s.fate != 0) return result;
  pz_beam b = pz_leave(PZ_P s, 3);
  result.ray = pz_ray_of(PZ_P s, b);
  /* rays that graze a surface have no finite derivatives */
  if (b.fate != 0 || !pz_finite(pz_dot(b.ray[1].p, b.ray[1].p) + pz_dot(b.ray[2].p, b.ray[2].p))) return result;
  result.direction_by_x = b.ray[1].p;
  result.direction_by_y = b.ray[2].p;
  /* from b.at to the front, on which origins stay: N (by + t d_by + t_by d) = 0 */
  pz_vector o = result.ray.origin, d = result.ray.direction, n;
  float c = PZ_AT(PZ_FRONT_CURVATURE), t = pz_dot(pz_along(o, -1.0f, b.ray[0].at), d), per;
  pz_vector x = pz_along(b.ray[1].at, t, b.ray[1].p), y = pz_along(b.ray[2].at, t, b.ray[2].p);
  n = pz_xyz(c * o.x, c * o.y, c * (o.z - PZ_AT(PZ_FRONT_Z)) - 1.0f);
  per = pz_dot(n, d);
  result.origin_by_x = pz_along(x, -pz_dot(n, x) / per, d);
  result.origin_by_y = pz_along(y, -pz_dot(n, y) / per, d);
  return result;
}

/* ---- From the scene to the film ---- */

/* A ray of the scene behind the lens: its film point and its pupil point. */
PZ_STRUCT(pz_path) {
  pz_point film, pupil;
  int fate;
};
/* The film and pupil point whose ray by polynomials has the line of a ray, by Newton's method from a point nearby. */
PZ_FN pz_path pz_corrected(PZ_T pz_path path, pz_vector o, pz_vector d, int w) {
  pz_four x = pz_in_domain(PZ_P path.film, path.pupil), wanted, here, next;
  float a[20], off = 1.0f, h = 0.015625f;
  o.z -= PZ_AT(PZ_REFERENCE_Z);
  o = pz_along(o, -pz_dot(o, d), d);
  wanted.v[0] = -d.x / (1.0f + d.z);
  wanted.v[1] = -d.y / (1.0f + d.z);
  wanted.v[2] = o.x + o.z * wanted.v[0];
  wanted.v[3] = o.y + o.z * wanted.v[1];
  for (int i = 0; i < 5 && off > 1.0e-6f; ++i) {
    here = pz_sums(PZ_P w, x);
    for (int k = 0; k < 4; ++k) { /* derivatives by differences */
      next = x;
      next.v[k] += h;
      next = pz_sums(PZ_P w, next);
      for (int r = 0; r < 4; ++r) a[5 * r + k] = (next.v[r] - here.v[r]) / h;
      a[5 * k + 4] = wanted.v[k] - here.v[k];
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
      float shift = a[5 * k + 4] / a[5 * k + k];
      x.v[k] += shift;
      off += pz_abs(shift);
    }
  }
  path.fate = off < 1.0e-3f ? pz_fate_in_domain(x) : 5;
  path.film = pz_xy(x.v[0] * PZ_AT(PZ_DOMAIN_FILM), x.v[1] * PZ_AT(PZ_DOMAIN_FILM));
  path.pupil = pz_xy(x.v[2] * PZ_AT(PZ_DOMAIN_RADIUS_X) + PZ_AT(PZ_DOMAIN_SHIFT_X) * path.film.x,
                     x.v[3] * PZ_AT(PZ_DOMAIN_RADIUS_Y) + PZ_AT(PZ_DOMAIN_SHIFT_Y) * path.film.y);
  return path;
}
PZ_FN pz_point pz_in_z_plane(pz_follower ray, float z) {
  float to = (z - ray.at.z) / ray.p.z;
  return pz_xy(ray.at.x + to * ray.p.x, ray.at.y + to * ray.p.y);
}
/* origin: a point of the ray near the lens */
PZ_FN pz_path pz_arrive(PZ_T pz_vector origin, pz_vector direction, pz_light light) {
  pz_path path;
  pz_beam b;
  PZ_BOOL exact = PZ_AT(PZ_RAYS) == 0.0f;
  b.ray[0].at = origin;
  b.ray[0].p = direction;
  b = pz_trace(PZ_P b, light, PZ_TRUE, exact, 1);
  path.film = pz_in_z_plane(b.ray[0], PZ_AT(PZ_FILM_Z));
  path.pupil = pz_in_z_plane(b.ray[0], PZ_AT(PZ_PUPIL_Z));
  path.fate = b.fate != 0 || pz_finite(path.film.x + path.film.y + path.pupil.x + path.pupil.y) ? b.fate : 1;
  return exact || path.fate != 0 ? path : pz_corrected(PZ_P path, origin, direction, light.nearest);
}
PZ_FN pz_arrival pz_dark(pz_point film, int fate) {
  pz_arrival dark;
  dark.film = film;
  dark.we = dark.pdf_film = dark.pdf_pupil = dark.pdf_position = dark.pdf_direction = 0.0f;
  dark.fate = fate;
  return dark;
}
/* The importance of a ray of the scene, with unit direction into the lens. */
PZ_FN pz_arrival pz_importance(PZ_T pz_vector origin, pz_vector direction, float nm) {
  pz_arrival found = pz_dark(pz_xy(0.0f, 0.0f), 0);
  pz_light light = pz_light_of(PZ_P nm);
  float length2 = pz_dot(direction, direction), sound = pz_dot(origin, direction) * 0.0f, area;
  if (!pz_has_light(PZ_P light)) return pz_dark(found.film, 8);
  if (!(sound >= 0.0f && pz_abs(length2 - 1.0f) < 1.0e-3f)) return pz_dark(found.film, 7);
  origin = pz_along(origin, -pz_dot(origin, direction), direction); /* the point nearest to the first vertex */
  pz_path path = pz_arrive(PZ_P origin, pz_times(1.5f - 0.5f * length2, direction), light);
  if (path.fate != 0) return pz_dark(found.film, path.fate);
  if (!pz_on_film(PZ_P path.film)) return pz_dark(path.film, 6);
  area = pz_area_at(PZ_P pz_find_pupil(PZ_P path.film.x, path.film.y, light.nearest), path.pupil);
  if (!(area > 0.0f)) return pz_dark(path.film, 3);
  pz_vector way = pz_xyz(path.pupil.x - path.film.x, path.pupil.y - path.film.y, PZ_AT(PZ_PUPIL_Z) - PZ_AT(PZ_FILM_Z));
  length2 = pz_dot(way, way);
  found.film = path.film;
  found.we = pz_number(PZ_P light, 1);
  found.pdf_film = 1.0f / (PZ_AT(PZ_FILM_WIDTH) * PZ_AT(PZ_FILM_HEIGHT));
  found.pdf_pupil = 1.0f / area;
  area = pz_number(PZ_P light, 3);
  found.pdf_position = area < 3.0e38f ? 1.0f / area : 1.0f; /* a pupil at infinity has no position */
  found.pdf_direction = pz_number(PZ_P light, 2) * length2 * length2 * found.pdf_pupil / found.pdf_position;
  return found;
}

/* The pupil of a scene point: a polygon in the plane through the centre that faces the point. Nodes lie over reciprocal
 * distance and field (one angle for a lens of revolution, two angles with cylinders). */
PZ_STRUCT(pz_scene) {
  PZ_BOOL known;
  pz_cell cell;
  float distance;             /* from the centre */
  pz_vector ahead, right, up; /* unit: to the centre, and across */
  pz_vector x, y;             /* axes of the polygon, unit */
};
PZ_FN pz_scene pz_find_scene(PZ_T pz_vector from, int w) {
  pz_scene s;
  PZ_BOOL two = PZ_AT(PZ_SCENE_DIMENSIONS) == 3.0f;
  float z = from.z - PZ_AT(PZ_CENTRE_Z), r2 = from.x * from.x + from.y * from.y, r = PZ_SQRT(r2);
  float steepest = PZ_AT(PZ_STEEPEST), rim = PZ_AT(PZ_FRONT_HALF), per, sine, cosine, field, at, across, down;
  float azimuth_x = r2 > 0.0f ? from.x / r : 0.0f, azimuth_y = r2 > 0.0f ? from.y / r : 1.0f;
  int fields = two ? 6 : 12, angles = two ? 2 : 1, widest, i;
  s.distance = PZ_SQRT(r2 + z * z);
  per = 1.0f / (s.distance > 0.0f ? s.distance : 1.0f);
  sine = r * per;
  cosine = -z * per;
  s.ahead = pz_xyz(-azimuth_x * sine, -azimuth_y * sine, cosine);
  s.right = s.x = pz_xyz(azimuth_y, -azimuth_x, 0.0f);
  s.up = s.y = pz_xyz(azimuth_x * cosine, azimuth_y * cosine, sine);
  if (two) { /* along x and y, with mirror images */
    s.x = pz_times(azimuth_x < 0.0f ? -1.0f : 1.0f, pz_along(pz_times(azimuth_y, s.right), azimuth_x, s.up));
    s.y = pz_times(azimuth_y < 0.0f ? -1.0f : 1.0f, pz_along(pz_times(azimuth_y, s.up), -azimuth_x, s.right));
  }
  /* The place in the grid: distance, field along y, field along x. */
  s.known = (r2 > rim * rim || z < 0.0f) && steepest * s.distance >= 1.0f && pz_finite(s.distance);
  at = s.known && per < steepest ? 2.0f * per / steepest : s.known ? 2.0f : 0.0f;
  i = pz_below(2, at);
  widest = pz_whole(PZ_P PZ_WIDEST) + (3 * w + i) * angles;
  field = 6.28318530718f * pz_turn_of(sine, cosine) * PZ_FLOAT(fields);
  across = (two ? field * pz_abs(azimuth_x) : field) / pz_linear(PZ_P widest, angles, at - PZ_FLOAT(i));
  down = two ? field * pz_abs(azimuth_y) / pz_linear(PZ_P widest + 1, angles, at - PZ_FLOAT(i)) : 0.0f;
  s.known = s.known && across <= PZ_FLOAT(fields) && down <= PZ_FLOAT(fields);
  s.cell = pz_cell_at(PZ_SCENE_NODES, w, pz_xyz(across, down, at), fields, two ? fields : 0, 2);
  return s;
}
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
PZ_FN PZ_BOOL pz_has_polygons(PZ_T int w, float distance) {
  int angles = PZ_AT(PZ_SCENE_DIMENSIONS) == 3.0f ? 2 : 1;
  return PZ_AT(pz_whole(PZ_P PZ_WIDEST) + w * 3 * angles) > 0.0f && PZ_AT(PZ_STEEPEST) * distance >= 1.0f;
}

/* A sampled connection from a scene point (lens frame, mm) through the lens to the film. */
PZ_FN pz_connection pz_connect(PZ_T pz_vector from, float u, float v, float nm) {
  pz_connection c;
  pz_light light = pz_light_of(PZ_P nm);
  pz_vector at;
  float to_front, sound = (u + v) * 0.0f;
  c.direction = pz_xyz(0.0f, 0.0f, 1.0f);
  c.end = pz_xyz(0.0f, 0.0f, 0.0f);
  c.distance = c.pdf = 0.0f;
  c.arrival = pz_dark(pz_xy(0.0f, 0.0f), light.nearest < 0 ? 8 : 3);
  if (light.nearest < 0 || !(sound >= 0.0f)) return c;
  pz_scene s = pz_find_scene(PZ_P from, light.nearest);
  u = pz_clamped(u);
  v = pz_clamped(v);
  if (s.known) {
    pz_sector own = pz_sector_after(PZ_P s.cell, u);
    pz_point q = pz_in_polygon(PZ_P s.cell, own, v);
    float area = pz_area_of(own), length;
    at = pz_along(pz_times(q.x, s.x), q.y, s.y);
    c.direction = pz_along(s.ahead, 1.0f / s.distance, at);
    length = PZ_SQRT(pz_dot(c.direction, c.direction));
    c.direction = pz_times(1.0f / length, c.direction);
    c.distance = s.distance * length;
    if (area > 0.0f) c.pdf = length * c.distance / area * c.distance;
    at.z += PZ_AT(PZ_CENTRE_Z);
  }
  if (!(c.pdf > 0.0f)) {
    if (!pz_sees(PZ_P from, light.nearest) || pz_has_polygons(PZ_P light.nearest, s.distance)) return c;
    float solid = pz_cone(PZ_P light.nearest, s.distance);
    float less = v * solid / 6.28318530718f; /* 1 - cosine of the angle to the centre */
    float sine = PZ_SQRT(less * (2.0f - less));
    pz_point turned = pz_circle(u);
    c.direction = pz_along(pz_times(1.0f - less, s.ahead), sine * turned.y, s.right);
    c.direction = pz_along(c.direction, sine * turned.x, s.up);
    c.distance = less < 1.0f ? s.distance * (1.0f - less) : 0.0f;
    at = pz_along(from, c.distance, c.direction);
    c.pdf = 1.0f / solid;
  }
  c.arrival = pz_importance(PZ_P at, c.direction, nm);
  to_front = pz_to_front(PZ_P at, pz_times(-1.0f, c.direction));
  to_front = to_front < c.distance ? to_front : c.distance;
  c.distance -= to_front;
  c.end = pz_along(at, -to_front, c.direction);
  return c;
}
/* The density with which pz_connect() samples a direction at a point, 1/sr; a unit vector. */
PZ_FN float pz_pdf(PZ_T pz_vector from, pz_vector direction, float nm) {
  pz_light light = pz_light_of(PZ_P nm);
  if (light.nearest < 0 || !pz_sees(PZ_P from, light.nearest)) return 0.0f;
  pz_scene s = pz_find_scene(PZ_P from, light.nearest);
  float cosine = pz_dot(direction, s.ahead), squared;
  if (!pz_has_polygons(PZ_P light.nearest, s.distance)) {
    float solid = pz_cone(PZ_P light.nearest, s.distance);
    return 1.0f - cosine <= solid / 6.28318530718f * 1.000001f ? 1.0f / solid : 0.0f;
  }
  if (!(s.known && cosine > 0.0f)) return 0.0f;
  pz_vector met = pz_times(s.distance / cosine, direction); /* from the point to the plane */
  pz_point q = pz_plus(pz_xy(pz_dot(met, s.x), pz_dot(met, s.y)), -1.0f, pz_middle(PZ_P s.cell));
  pz_sector own = pz_sector_towards(PZ_P s.cell, q);
  squared = pz_squared_at(own, q);
  if (!(squared >= 0.0f && squared <= 1.0f)) return 0.0f;
  return s.distance / pz_area_of(own) * s.distance / (cosine * cosine * cosine);
}

#endif /* PETZVAL_CAMERA_H */
