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
 * gcc and clang need -fno-math-errno, which is also faster, or -lm. g++ 12 with -march=native needs -mtune=generic:
 * tuned for AMD Zen 3, rays take 1.5 times as long.
 *
 * In shaders the table is a buffer, not a parameter. Define PETZVAL_GLSL or PETZVAL_HLSL and PETZVAL_TABLE(i), element
 * i of the table, before this file, and leave out the first argument of all functions:
 *
 *     layout(std430, binding = 0) readonly buffer Camera { float camera_table[]; };
 *     #define PETZVAL_GLSL
 *     #define PETZVAL_TABLE(i) camera_table[i]
 *
 * Functions: pz_valid, pz_film_point, pz_raster, pz_sample, pz_sample_differential, pz_importance, pz_connect, pz_pdf
 * and pz_ghost_of. Other functions are internal. Frame of the lens: z runs along the axis from the scene to the film;
 * the vertex of the first surface is at 0. Lengths are in mm, wavelengths in nm. Fates of rays: 0 transmitted, 1 missed
 * a surface, 2 total reflection, 3 clipped by an aperture, 5 outside the fit of a polynomial, 6 outside the film, 7
 * invalid, 8 outside the wavelengths of the table.
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
#if defined(PETZVAL_GLSL) || defined(PETZVAL_HLSL) || defined(__cplusplus)
#define PZ_BOOL bool
#define PZ_FLOAT(x) float(x)
#define PZ_INT(x) int(x)
#else
#define PZ_BOOL int
#define PZ_FLOAT(x) ((float)(x))
#define PZ_INT(x) ((int)(x))
#endif
#define PZ_TRUE (1 == 1)
#define PZ_FALSE (1 == 0)

/* ---- Positions in the table ---- */

#define PZ_FORMAT 7 /* number at position 0 */
#define PZ_RAYS 2   /* 0: surfaces, 1: polynomial */
#define PZ_WAVELENGTH_COUNT 3
#define PZ_PRIMARY 4
#define PZ_WAVELENGTHS 5
#define PZ_SHORTEST 6
#define PZ_LONGEST 7
#define PZ_T_SCALE 8
#define PZ_T_OFFSET 9
#define PZ_NUMBERS 10
#define PZ_POWERS 11
#define PZ_FILM_Z 12
#define PZ_PUPIL_Z 13
#define PZ_FILM_X 14
#define PZ_FILM_Y 15
#define PZ_FILM_WIDTH 16
#define PZ_FILM_HEIGHT 17
#define PZ_MARGIN 18
#define PZ_COLUMNS 19
#define PZ_ROWS 20
#define PZ_FRONT_Z 21
#define PZ_FRONT_CURVATURE 22
#define PZ_FRONT_FIRST 23
#define PZ_SURFACE_COUNT 24
#define PZ_SURFACES 25
#define PZ_MIRRORS 26
#define PZ_EDGES 27
#define PZ_BLADES 28
#define PZ_IRIS_AREA 29
#define PZ_IRIS 30
#define PZ_REACH 31
#define PZ_ROWS_PER_MM 32
#define PZ_HALF_WIDTHS 33
#define PZ_FILM_GRID 34 /* six numbers, see pz_cell_at() */
#define PZ_TERMS 40
#define PZ_DEGREE 41
#define PZ_DOMAIN 42 /* radius of the film, then shift and radius of the pupil along x, and along y */
#define PZ_REFERENCE_Z 47
#define PZ_CENTRE_Z 48
#define PZ_STEEPEST 49
#define PZ_FRONT_HALF 50
#define PZ_WIDEST 51
#define PZ_BALLS 52
#define PZ_SCENE_GRID 53
#define PZ_HEAD 59
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
/* A ray of the scene at the film after two reflections in the lens. */
PZ_STRUCT(pz_ghost) {
  pz_point film;
  float weight; /* fraction of the power of the ray; 0 if the ray is lost */
  int fate;
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
/* Point of the unit circle at a fraction of a turn: Taylor series at a quarter of its angle to -y, doubled twice. */
PZ_FN pz_point pz_circle(float u) {
  float angle = 1.57079632679f * (u - 0.5f), s = angle * angle, twice;
  float sine = angle * (1.0f - s / 6.0f * (1.0f - s / 20.0f * (1.0f - s / 42.0f * (1.0f - s / 72.0f))));
  float cosine = 1.0f - s / 2.0f * (1.0f - s / 12.0f * (1.0f - s / 30.0f * (1.0f - s / 56.0f * (1.0f - s / 90.0f))));
  for (int i = 0; i < 2; ++i) {
    twice = 2.0f * sine * cosine;
    cosine = 1.0f - 2.0f * sine * sine;
    sine = twice;
  }
  return pz_xy(-sine, -cosine);
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
  return pz_abs(film.x - PZ_AT(PZ_FILM_X)) <= 1.000001f * (0.5f * PZ_AT(PZ_FILM_WIDTH) + PZ_AT(PZ_MARGIN)) &&
         pz_abs(film.y - PZ_AT(PZ_FILM_Y)) <= 1.000001f * (0.5f * PZ_AT(PZ_FILM_HEIGHT) + PZ_AT(PZ_MARGIN));
}

/* ---- Wavelengths ---- */

/* A wavelength in the table. */
PZ_STRUCT(pz_light) {
  int nearest; /* index of the nearest compiled wavelength; -1: there are no rays of this wavelength */
  int numbers; /* position of the numbers of a compiled wavelength; 0: polynomials of t give the numbers */
  float t;     /* coordinate from -1 to 1, linear in 1 / nm */
};
PZ_FN pz_light pz_light_of(PZ_T float nm) {
  pz_light found;
  float least = 3.0e38f, t = PZ_AT(PZ_T_SCALE) / nm - PZ_AT(PZ_T_OFFSET);
  int count = pz_whole(PZ_P PZ_WAVELENGTH_COUNT), list = pz_whole(PZ_P PZ_WAVELENGTHS);
  found.nearest = -1;
  found.numbers = 0;
  found.t = t < 1.0f ? (t > -1.0f ? t : -1.0f) : 1.0f;
  for (int w = 0; w < count; ++w) {
    float away = pz_abs(nm - PZ_AT(list + w));
    if (away < least) found.nearest = w;
    least = away < least ? away : least;
  }
  if (least <= 0.005f) { /* nm */
    found.numbers = pz_whole(PZ_P PZ_NUMBERS) + found.nearest * (5 + 2 * pz_whole(PZ_P PZ_SURFACE_COUNT));
  } else if (PZ_AT(PZ_RAYS) == 1.0f || !(nm >= PZ_AT(PZ_SHORTEST) && nm <= PZ_AT(PZ_LONGEST))) {
    found.nearest = -1; /* rays by polynomials have the compiled wavelengths only */
  }
  return found;
}
/* A number that depends on the wavelength: 0 scale of weights, 1 importance, 2 density of film samples, 3 area of the
 * entrance pupil, then the squared index of each space, then its change at each surface. */
PZ_FN float pz_number(PZ_T pz_light light, int k) {
  float sum = 0.0f;
  if (light.numbers != 0) return PZ_AT(light.numbers + k);
  for (int i = 7, at = pz_whole(PZ_P PZ_POWERS) + 8 * k; i >= 0; --i) sum = sum * light.t + PZ_AT(at + i);
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
/* True if the table has the nodes of a grid for w wavelengths; see pz_cell_at(). */
PZ_FN PZ_BOOL pz_has_grid(PZ_T int grid, int w) {
  int floats = pz_whole(PZ_P 1), size = pz_count(PZ_P grid + 1, floats), polygon = pz_count(PZ_P grid + 2, size);
  for (int axis = 3; axis < 6; ++axis) w = pz_product(w, 1 + pz_count(PZ_P grid + axis, floats), floats);
  return (polygon == 132 || polygon == 260) && PZ_AT(grid + 3) > 0.0f && w > 0 && pz_has(PZ_P grid, w, size);
}
/* True if `floats` numbers are a complete table of this format: no function reads outside of such a table. All other
 * functions trust their table: call this one first, for each table from a file. Tables of other formats have to be
 * exported again: `petzval export LENS --camera FILE`. */
PZ_FN PZ_BOOL pz_valid(PZ_T int floats) {
  if (floats < PZ_HEAD || floats > 16777216 || PZ_AT(0) != PZ_FLOAT(PZ_FORMAT) || PZ_AT(1) != PZ_FLOAT(floats)) {
    return PZ_FALSE;
  }
  int w = pz_count(PZ_P PZ_WAVELENGTH_COUNT, floats), surfaces = pz_count(PZ_P PZ_SURFACE_COUNT, floats);
  int blades = pz_count(PZ_P PZ_BLADES, floats), rays = pz_count(PZ_P PZ_RAYS, 1), numbers = 5 + 2 * surfaces;
  PZ_BOOL sound = w > 0 && surfaces > 0 && blades >= 0 && rays >= 0 && pz_count(PZ_P PZ_PRIMARY, w - 1) >= 0 &&
                  pz_count(PZ_P PZ_MIRRORS, surfaces) >= 0 && pz_has(PZ_P PZ_WAVELENGTHS, w, 1) &&
                  pz_has(PZ_P PZ_NUMBERS, w, numbers) && pz_has(PZ_P PZ_SURFACES, surfaces, PZ_SURFACE_SIZE) &&
                  pz_has(PZ_P PZ_EDGES, blades, 4) && pz_has(PZ_P PZ_BALLS, w, 1) &&
                  pz_has_grid(PZ_P PZ_FILM_GRID, w) && pz_has_grid(PZ_P PZ_SCENE_GRID, w);
  if (!sound) return PZ_FALSE;
  for (int i = 0; i < surfaces; ++i) {
    int at = pz_whole(PZ_P PZ_SURFACES) + i * PZ_SURFACE_SIZE + 10;
    int terms = pz_has(PZ_P at, 4, 1) ? pz_count(PZ_P pz_whole(PZ_P at) + 2, floats) : -1;
    if (PZ_AT(at) != 0.0f && (terms < 0 || !pz_has(PZ_P at, 4 + terms, 1))) return PZ_FALSE;
  }
  int rows = pz_whole(PZ_P PZ_FILM_GRID + 4), stop = pz_whole(PZ_P PZ_FILM_GRID + 1) - pz_whole(PZ_P PZ_FILM_GRID + 2);
  int layers = pz_whole(PZ_P PZ_SCENE_GRID + 5), angles = PZ_AT(PZ_SCENE_GRID + 4) > 0.0f ? 2 : 1;
  int degree = rays == 0 ? 1 : pz_count(PZ_P PZ_DEGREE, 99), n = (degree - 1) / 2;
  int terms = (n + 1) * (n + 2) * (n + 3) / 6 * (rows > 0 ? 4 * (n + 2) : 4);
  /* Numbers between the compiled wavelengths are needed if a sample can have such a wavelength. */
  pz_light end = pz_light_of(PZ_P PZ_AT(PZ_SHORTEST));
  PZ_BOOL between = PZ_AT(PZ_SHORTEST) < PZ_AT(PZ_LONGEST) || (end.nearest >= 0 && end.numbers == 0);
  return (!between || pz_has(PZ_P PZ_POWERS, numbers, 8)) && (rows == 0 || pz_has(PZ_P PZ_HALF_WIDTHS, rows + 1, 1)) &&
         (stop == 0 || (blades > 0 && stop >= (rows > 0 ? 158 : 150) && pz_has(PZ_P PZ_IRIS, 16 + 6 * blades, 1))) &&
         layers > 0 && pz_has(PZ_P PZ_WIDEST, w, (layers + 1) * angles) &&
         PZ_AT(PZ_SCENE_GRID + 1) == PZ_AT(PZ_SCENE_GRID + 2) && degree > 0 &&
         (rays == 0 || pz_has(PZ_P PZ_TERMS, w, terms));
}

/* ---- Polygons between nodes ---- */

/* A cell of a grid of nodes, and a place in the cell. Numbers of nodes are linear along each axis of the grid. */
PZ_STRUCT(pz_cell) {
  int at, size, polygon; /* position of its first node, numbers of a node, numbers of the polygon of a node */
  int row, layer;        /* numbers from one node to the next along the second and the third axis; 0: no such axis */
  float t, s, r;         /* fractions along the axes */
};
/* The cell of a place, whose coordinates count cells. The six numbers of a grid are the position of its nodes, the
 * numbers of a node, the numbers of its polygon and the cells along each axis; 0: there is no such axis. */
PZ_FN pz_cell pz_cell_at(PZ_T int grid, int w, pz_vector place) {
  pz_cell c;
  int cells = pz_whole(PZ_P grid + 3), rows = pz_whole(PZ_P grid + 4), layers = pz_whole(PZ_P grid + 5);
  int i = pz_below(cells, place.x), j = pz_below(rows, place.y), k = pz_below(layers, place.z);
  c.size = pz_whole(PZ_P grid + 1);
  c.polygon = pz_whole(PZ_P grid + 2);
  c.row = rows > 0 ? (cells + 1) * c.size : 0;
  c.layer = layers > 0 ? (rows + 1) * (cells + 1) * c.size : 0;
  c.at = pz_whole(PZ_P grid) + (w * (layers + 1) * (rows + 1) * (cells + 1) + i) * c.size + j * c.row + k * c.layer;
  c.t = place.x - PZ_FLOAT(i);
  c.s = place.y - PZ_FLOAT(j);
  c.r = place.z - PZ_FLOAT(k);
  return c;
}
PZ_FN float pz_linear(PZ_T int at, int step, float t) { return PZ_AT(at) + t * (PZ_AT(at + step) - PZ_AT(at)); }
PZ_FN float pz_bilinear(PZ_T pz_cell c, int at) {
  float sum = pz_linear(PZ_P at, c.size, c.t);
  return c.row == 0 ? sum : sum + c.s * (pz_linear(PZ_P at + c.row, c.size, c.t) - sum);
}
/* Number k of the nodes. */
PZ_FN float pz_between(PZ_T pz_cell c, int k) {
  float sum = pz_bilinear(PZ_P c, c.at + k);
  return c.layer == 0 ? sum : sum + c.r * (pz_bilinear(PZ_P c, c.at + k + c.layer) - sum);
}
PZ_FN pz_point pz_point_between(PZ_T pz_cell c, int k) {
  return pz_xy(pz_between(PZ_P c, k), pz_between(PZ_P c, k + 1));
}

/* A pupil is a polygon: a middle and 64 corners around it, in order from +y towards +x. Sector k is the triangle from
 * the middle to corners k and k + 1. All sectors get the same number of samples. */
PZ_STRUCT(pz_sector) {
  int k;
  pz_point a, b;         /* the corners, relative to the middle */
  float along;           /* a place on the outer edge, from a (0) to b (1) */
  float dark_from, dark; /* begin and width of the obscured interval of squared relative radii */
};
PZ_FN pz_point pz_middle(PZ_T pz_cell c) { return pz_point_between(PZ_P c, 0); }
PZ_FN pz_point pz_corner(PZ_T pz_cell c, int k) { return pz_point_between(PZ_P c, 2 + 2 * k); }
/* Twice the area of the triangle from the middle to a and b. */
PZ_FN float pz_turn(pz_point a, pz_point b) { return b.x * a.y - a.x * b.y; }
PZ_FN pz_sector pz_sector_of(PZ_T pz_cell c, int k, float along) {
  pz_sector s;
  pz_point dark = pz_xy(0.0f, 0.0f);
  if (c.polygon > 132) dark = pz_point_between(PZ_P c, 132 + 2 * k);
  s.k = k;
  s.a = pz_corner(PZ_P c, k);
  s.b = pz_corner(PZ_P c, k + 1);
  s.along = along;
  s.dark_from = dark.x;
  s.dark = dark.y;
  return s;
}
/* The place on the outer edge, relative to the middle. */
PZ_FN pz_point pz_edge(pz_sector s) { return pz_plus(s.a, s.along, pz_plus(s.b, -1.0f, s.a)); }
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
  pz_sector s = pz_sector_of(PZ_P c, k, 0.0f);
  float behind = pz_turn(s.a, q), sum = behind + pz_turn(q, s.b);
  s.along = sum > 0.0f ? behind / sum : 0.0f;
  return s;
}
/* v of a point q in its sector, 0 in the middle and 1 at the edge; -1: no sample has this place. */
PZ_FN float pz_v_at(pz_sector s, pz_point q) {
  float behind = pz_turn(s.a, q), before = pz_turn(q, s.b), whole = pz_turn(s.a, s.b);
  float squared = (behind + before) / whole * ((behind + before) / whole);
  if (!(behind >= 0.0f && before >= 0.0f && whole > 0.0f && squared <= 1.0f)) return -1.0f;
  return squared >= s.dark_from && squared < s.dark_from + s.dark ? -1.0f : pz_fraction_within(s, squared);
}

/* ---- Pupils ---- */

/* The pupil of a film point, or of a scene point. Film points, one axis: rows over the distance from the axis, with
 * polygons that turn with the film point. Two axes: the quadrant x, y >= 0, with mirror images for the others. */
PZ_STRUCT(pz_pupil) {
  PZ_BOOL known;
  pz_cell cell;
  pz_point x, y;        /* unit: the axes of the polygon, in the frame of the point */
  float turn, flip;     /* u is turn at the first corner; flip: -1 for mirror images */
  float t_by_x, t_by_y; /* derivatives of t by the coordinates of the film point along x and y */
};
PZ_FN pz_pupil pz_find_pupil(PZ_T float x, float y, int w) {
  pz_pupil p;
  float r2 = x * x + y * y, r = PZ_SQRT(r2), per_mm = PZ_AT(PZ_ROWS_PER_MM);
  int columns = pz_whole(PZ_P PZ_FILM_GRID + 3), rows = pz_whole(PZ_P PZ_FILM_GRID + 4);
  pz_vector place = pz_xyz(r * per_mm, 0.0f, 0.0f);
  p.known = r <= PZ_AT(PZ_REACH);
  p.y = r2 > 1.0e-31f ? pz_xy(x / r, y / r) : pz_xy(0.0f, 1.0f);
  p.x = pz_xy(p.y.y, -p.y.x);
  p.flip = 1.0f;
  p.t_by_x = 0.0f;
  p.t_by_y = per_mm;
  if (rows > 0) {
    float up = pz_abs(y) * per_mm;
    int row = pz_below(rows, up), widths = pz_whole(PZ_P PZ_HALF_WIDTHS) + row;
    float width = pz_linear(PZ_P widths, 1, up - PZ_FLOAT(row)), change = PZ_AT(widths + 1) - PZ_AT(widths);
    p.known = p.known && up <= 1.000001f * PZ_FLOAT(rows) && pz_abs(x) <= 1.000001f * width;
    p.t_by_x = width > 0.0f ? PZ_FLOAT(columns) / width : 0.0f;
    place = pz_xyz(pz_abs(x) * p.t_by_x, up, 0.0f);
    p.t_by_y = width > 0.0f ? -place.x * change * per_mm / width : 0.0f;
    p.x = pz_xy(x < 0.0f ? -1.0f : 1.0f, 0.0f);
    p.y = pz_xy(0.0f, y < 0.0f ? -1.0f : 1.0f);
    p.flip = p.x.x * p.y.y;
  }
  p.turn = pz_turn_of(p.y.x, p.y.y); /* u starts at +y of the film, corners start at +y of the grid */
  p.cell = pz_cell_at(PZ_P PZ_FILM_GRID, w, place);
  return p;
}
/* A point in the frame of the film from the frame of the grid, and back. */
PZ_FN pz_point pz_to_film(pz_pupil p, pz_point q) {
  return pz_xy(p.x.x * q.x + p.y.x * q.y, p.x.y * q.x + p.y.y * q.y);
}
PZ_FN pz_point pz_to_grid(pz_pupil p, pz_point q) {
  return pz_xy(p.x.x * q.x + p.x.y * q.y, p.y.x * q.x + p.y.y * q.y);
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

/* True if samples are points of the iris, false if they are points of the polygon inside the iris. */
PZ_FN PZ_BOOL pz_samples_iris(PZ_T pz_pupil p) {
  return p.cell.size > p.cell.polygon && PZ_AT(p.cell.at + p.cell.polygon + (p.cell.row > 0 ? 26 : 18)) > 0.0f;
}
/* The image of a stop point in the pupil plane, in the frame of the grid. x and y: value, derivatives by the stop's x
 * and y */
PZ_STRUCT(pz_seen) { pz_vector x, y; };
/* Terms of these polynomials. Their loop has no constant length: compilers of shaders unroll such loops. */
PZ_STRUCT(pz_terms) { float a[20]; };
/* A polynomial of the stop point up to the third power: ten terms from term k on. */
PZ_FN pz_vector pz_cubic(pz_terms t, int k, float x, float y) {
  float a1 = t.a[k + 1], a2 = t.a[k + 2], a3 = t.a[k + 3], a4 = t.a[k + 4], a5 = t.a[k + 5], a6 = t.a[k + 6];
  float a7 = t.a[k + 7], a8 = t.a[k + 8], a9 = t.a[k + 9], xx = x * x, yy = y * y;
  return pz_xyz(t.a[k] + x * (a1 + a3 * x + a4 * y + a6 * xx + a8 * yy) + y * (a2 + a5 * y + a7 * xx + a9 * yy),
                a1 + 2.0f * (a3 * x + a7 * x * y) + a4 * y + 3.0f * a6 * xx + a8 * yy,
                a2 + 2.0f * (a5 * y + a8 * x * y) + a4 * x + 3.0f * a9 * yy + a7 * xx);
}
PZ_FN pz_seen pz_see(PZ_T pz_pupil p, float x, float y) {
  pz_seen seen;
  pz_terms t;
  int terms = p.cell.row > 0 ? 20 : 15;
  for (int i = 0; i < terms; ++i) t.a[i] = pz_between(PZ_P p.cell, p.cell.polygon + 1 + i);
  if (p.cell.row > 0) {
    seen.x = pz_cubic(t, 0, x, y);
    seen.y = pz_cubic(t, 10, x, y);
    return seen;
  }
  float xx = x * x, yy = y * y, r = xx + yy, r2 = r * r;
  float across = t.a[9] + y * (t.a[10] + t.a[13] * r) + t.a[11] * xx + t.a[12] * yy + t.a[14] * r2;
  float by_x = 2.0f * x * (t.a[11] + t.a[13] * y + 2.0f * t.a[14] * r);
  float by_y = t.a[10] + 2.0f * t.a[12] * y + t.a[13] * (r + 2.0f * yy) + 4.0f * t.a[14] * r * y;
  seen.x = pz_xyz(x * across, across + x * by_x, x * by_y);
  seen.y.x = t.a[0] + y * (t.a[1] + t.a[3] * y + t.a[4] * xx + t.a[5] * yy + t.a[8] * r2);
  seen.y.x += t.a[2] * xx + t.a[6] * r2 + t.a[7] * r * yy;
  seen.y.y = 2.0f * x * (t.a[2] + t.a[4] * y + 2.0f * t.a[6] * r + t.a[7] * yy + 2.0f * t.a[8] * y * r);
  seen.y.z = t.a[1] + 2.0f * y * (t.a[3] + 2.0f * t.a[6] * r + t.a[7] * (r + yy)) + t.a[4] * xx;
  seen.y.z += 3.0f * t.a[5] * yy + t.a[8] * (r2 + 4.0f * yy * r);
  return seen;
}
PZ_FN float pz_determinant(pz_seen s) { return s.x.y * s.y.z - s.x.z * s.y.y; }
/* A step of Newton's method towards the stop point whose image is p. */
PZ_FN pz_point pz_newton_step(pz_seen s, pz_point p) {
  float per = 1.0f / pz_determinant(s), x = p.x - s.x.x, y = p.y - s.y.x;
  return pz_xy((s.y.z * x - s.x.z * y) * per, (s.x.y * y - s.y.y * x) * per);
}
PZ_FN float pz_iris_scale(PZ_T pz_pupil p) { return pz_between(PZ_P p.cell, p.cell.polygon); }
/* The area that a sample of the iris represents. */
PZ_FN float pz_iris_area(PZ_T pz_seen s, float scale) {
  return PZ_AT(PZ_IRIS_AREA) * scale * scale * pz_abs(pz_determinant(s));
}

/* The interval of a line from a (0) to a + d (1) inside all edges of the iris, as from = x, to = y. */
PZ_FN pz_point pz_cut(PZ_T pz_point a, pz_point d) {
  int blades = pz_whole(PZ_P PZ_BLADES), edge = pz_unit_edges(PZ_P blades);
  float from = 0.0f, to = 1.0f;
  for (int k = 0; k < blades; ++k, edge += 4) {
    float bend = PZ_AT(edge + 2), outside = -pz_inside(PZ_P edge, a), last = 2.0f, beyond = 2.0f;
    float square = bend * (d.x * d.x + d.y * d.y), slope = 2.0f * bend * (a.x * d.x + a.y * d.y);
    slope += PZ_AT(edge) * d.x + PZ_AT(edge + 1) * d.y;
    float inner = slope * slope - 4.0f * square * outside;
    float root = PZ_SQRT(inner > 0.0f ? inner : 0.0f), leaving = root + slope, entering = root - slope;
    if (inner >= 0.0f && outside * leaving < 0.0f) last = -2.0f * outside / leaving;
    if (inner >= 0.0f && entering > 0.0f) beyond = 2.0f * outside / entering;
    if (last < to) to = last;
    if (outside > 0.0f && beyond > from) from = beyond;
  }
  return pz_xy(from, to);
}
/* The interval of v inside the iris, on the line from the middle of a pupil to a place of its edge. The line is
 * straight in the pupil and nearly straight at the stop: a second pass corrects it at the clipped end. */
PZ_FN pz_point pz_clip(PZ_T pz_pupil p, pz_sector s) {
  if (p.cell.size == p.cell.polygon) return pz_xy(0.0f, 1.0f);
  int at = p.cell.polygon + (p.cell.row > 0 ? 24 : 16), corner = at + 4 + 2 * s.k;
  float scale = pz_iris_scale(PZ_P p), per = 1.0f / scale, look;
  pz_point begin = pz_point_between(PZ_P p.cell, at), a = pz_point_between(PZ_P p.cell, corner);
  pz_point b = pz_point_between(PZ_P p.cell, corner + 2), path, interval, straight, in_pupil, off;
  path = pz_xy(a.x + s.along * (b.x - a.x) - begin.x, a.y + s.along * (b.y - a.y) - begin.y);
  begin = pz_to_film(p, pz_xy(per * begin.x, per * begin.y));
  path = pz_to_film(p, pz_xy(per * path.x, per * path.y));
  interval = pz_cut(PZ_P begin, path);
  look = interval.y > 0.25f ? interval.y : 0.25f;
  straight = pz_to_grid(p, pz_plus(begin, look, path));
  in_pupil = pz_plus(pz_middle(PZ_P p.cell), look, pz_edge(s));
  off = pz_newton_step(pz_see(PZ_P p, scale * straight.x, scale * straight.y), in_pupil);
  interval = pz_cut(PZ_P begin, pz_plus(path, per / look, pz_to_film(p, off)));
  float from = interval.x < interval.y ? interval.x : interval.y;
  return pz_xy(pz_fraction_within(s, from * from), pz_fraction_within(s, interval.y * interval.y));
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
    float scale = pz_iris_scale(PZ_P p);
    pz_point stop = pz_to_grid(p, pz_iris_point(PZ_P u, v));
    pz_seen seen = pz_see(PZ_P p, scale * stop.x, scale * stop.y);
    result.at = pz_to_film(p, pz_xy(seen.x.x, seen.y.x));
    result.area = pz_iris_area(PZ_P seen, scale);
    return result;
  }
  u = p.flip * (u - p.turn);
  u = 64.0f * pz_clamped(u < 0.0f ? u + 1.0f : u > 1.0f ? u - 1.0f : u);
  int k = pz_below(64, u);
  pz_sector s = pz_sector_of(PZ_P p.cell, k, u - PZ_FLOAT(k));
  pz_point part = pz_clip(PZ_P p, s);
  float radius = PZ_SQRT(pz_squared_radius(s, part.x + v * (part.y - part.x)));
  result.at = pz_to_film(p, pz_plus(pz_middle(PZ_P p.cell), radius, pz_edge(s)));
  result.area = pz_area_of(s) * (part.y - part.x);
  return result;
}
/* The area of a sample of the iris at a point of the pupil plane, in the frame of the grid. */
PZ_FN float pz_iris_area_at(PZ_T pz_pupil p, pz_point q) {
  float scale = pz_iris_scale(PZ_P p), step2 = 0.0f;
  pz_point stop = pz_xy(0.0f, 0.0f), unit;
  for (int i = 0; i < 4; ++i) {
    pz_point by = pz_newton_step(pz_see(PZ_P p, stop.x, stop.y), q);
    step2 = by.x * by.x + by.y * by.y;
    stop = pz_plus(stop, 1.0f, by);
    float r2 = stop.x * stop.x + stop.y * stop.y; /* stays near the rim: outside, the polynomials are not fitted */
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
  pz_point part = pz_clip(PZ_P p, s);
  float v = pz_v_at(s, q);
  return v >= part.x && v <= part.y ? pz_area_of(s) * (part.y - part.x) : 0.0f;
}

/* ---- Rays through the surfaces ---- */

/* A ray on its way, or its derivative by film x or y. z counts from the vertex of the surface. p is the direction times
 * the index of the medium, so that refraction needs no division, and has the sense of light that travels to the film:
 * light in both directions is refracted alike. */
PZ_STRUCT(pz_line) { pz_vector at, p; };
PZ_STRUCT(pz_beam) {
  pz_line ray, by[2]; /* by film x, by film y */
  int fate;
};
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
  if (asphere != 0) { /* terms a_k rho^k, for k = 2, 2 + step, ... with rho^2 = v = u / height^2 */
    float height2 = PZ_AT(asphere) * PZ_AT(asphere), v = u / height2, step = PZ_AT(asphere + 3);
    float power = step == 2.0f ? v : PZ_SQRT(v), z = 0.0f, by_v = 0.0f, by_v2 = 0.0f;
    for (int i = pz_whole(PZ_P asphere + 2) - 1; i >= 0; --i) {
      float a = PZ_AT(asphere + 4 + i), k = 2.0f + step * PZ_FLOAT(i);
      z = z * power + a;
      by_v = by_v * power + k * a;
      by_v2 = by_v2 * power + k * (k - 2.0f) * a;
    }
    s.z += v * z;
    s.slope += by_v / height2;
    if (v > 1.0e-18f) s.bend += 0.5f * by_v2 / (v * height2 * height2); /* on the axis, the bend has no effect */
  }
  return s;
}

/* A point of a surface, where N = (-g.x, -g.y, g.z) is half the gradient of its equation. */
PZ_STRUCT(pz_contact) {
  pz_vector at, p, g;  /* the point; p in front of the surface */
  pz_vector c, across; /* N changes by -(c.x dx, c.y dy, c.z dz) - twist across (across . (dx, dy, dz)) */
  PZ_BOOL mirror;
  float twist, way, nn, xi, xo, gamma, k; /* way in units of p, N N, p N, p' N, (p' N - p N) / nn, n'^2 - n^2 */
};
/* The derivative of a ray behind a surface by the chain rule. */
PZ_FN pz_line pz_follow(pz_line d, pz_contact s) {
  pz_vector n, normal = pz_xyz(-s.g.x, -s.g.y, s.g.z);
  float xi, gamma;
  d.at = pz_along(d.at, s.way, d.p);
  d.at = pz_along(d.at, -pz_dot(normal, d.at) / s.xi, s.p); /* the point stays on the surface */
  n = pz_xyz(s.c.x * d.at.x, s.c.y * d.at.y, s.c.z * d.at.z);
  n = pz_along(n, s.twist * pz_dot(s.across, d.at), s.across);
  xi = pz_dot(normal, d.p) - pz_dot(n, s.p);
  gamma = -s.gamma / s.xo * xi - 2.0f * (0.5f * s.k / s.xo - s.gamma) / s.nn * pz_dot(normal, n);
  d.p = pz_along(pz_along(d.p, gamma, normal), -s.gamma, n);
  if (s.mirror) d.p = pz_times(-1.0f, d.p);
  return d;
}
PZ_FN pz_beam pz_stopped(pz_beam b, int fate) {
  b.fate = fate;
  return b;
}
/* One surface. n2: squared index in front of it; k: change of the squared index; clips: apertures clip the ray; follow:
 * with derivatives; reflects: as a mirror */
PZ_FN pz_beam pz_pass(PZ_T pz_beam b, int surface, float n2, float k, PZ_BOOL clips, PZ_BOOL follow, PZ_BOOL reflects) {
  float c = PZ_AT(surface + 2), e = PZ_AT(surface + 3), ax = PZ_AT(surface + 4), ay = PZ_AT(surface + 5), shift, r2, d;
  int asphere = pz_whole(PZ_P surface + 10);
  PZ_BOOL sphere = asphere == 0 && e == 1.0f && ax * ay == 1.0f, found = PZ_TRUE;
  pz_vector at = b.ray.at, p = b.ray.p, quadric = pz_xyz(ax * p.x, ay * p.y, e * p.z);
  pz_contact s;
  /* Near the vertex the quadratic loses no digits: go to its plane, or to the nearest point if the ray is steep. */
  if (p.z * pz_abs(p.z) > 0.09f * n2) {
    shift = -at.z / p.z;
    at = pz_xyz(at.x + shift * p.x, at.y + shift * p.y, 0.0f);
  } else {
    shift = -(quadric.x * at.x + quadric.y * at.y + at.z * p.z) / (quadric.x * p.x + quadric.y * p.y + p.z * p.z);
    at = pz_along(at, shift, p);
  }
  /* quadratic q^2 - 2 facing q + free = 0 for the base conic */
  float facing = p.z - c * pz_dot(quadric, at), quadratic = c * pz_dot(quadric, p);
  float free = c * (ax * at.x * at.x + ay * at.y * at.y + e * at.z * at.z) - 2.0f * at.z;
  d = facing * facing - quadratic * free;
  float root = PZ_SQRT(d > 0.0f ? d : 0.0f);
  s.p = p;
  s.twist = 0.0f;
  s.mirror = reflects || PZ_AT(surface + 8) != 0.0f;
  if (asphere == 0) {
    s.way = facing >= 0.0f ? free / (facing + root) : (facing - root) / quadratic;
    at = pz_along(at, s.way, p);
    s.across = pz_xyz(ax * at.x, ay * at.y, 0.0f);
    s.g = pz_xyz(c * s.across.x, c * s.across.y, 1.0f - c * e * at.z);
    s.c = pz_xyz(c * ax, c * ay, c * e);
    s.xi = root;
    found = d >= 0.0f && s.g.z > 0.0f && pz_finite(s.way);
  } else {
    float size = PZ_AT(asphere) + ax * pz_abs(at.x) + ay * pz_abs(at.y) + pz_abs(at.z);
    pz_sag sag;
    PZ_BOOL settled = PZ_FALSE;
    s.way = d > 0.0f && facing > 0.0f ? free / (facing + root) : 0.0f;
    for (int i = 0; i < 12 && !settled; ++i) { /* Newton's method */
      pz_vector on = pz_along(at, s.way, p);
      sag = pz_sag_of(PZ_P surface, ax * on.x * on.x + ay * on.y * on.y);
      s.xi = p.z - sag.slope * (quadric.x * on.x + quadric.y * on.y);
      settled = sag.defined && pz_abs(on.z - sag.z) <= 2.4e-7f * (size + pz_abs(s.way));
      s.way -= (on.z - sag.z) / s.xi;
    }
    at = pz_along(at, s.way, p);
    s.across = pz_xyz(ax * at.x, ay * at.y, 0.0f);
    s.g = pz_xyz(sag.slope * s.across.x, sag.slope * s.across.y, 1.0f);
    s.c = pz_xyz(sag.slope * ax, sag.slope * ay, 0.0f);
    s.twist = 2.0f * sag.bend;
    d = s.xi * s.xi;
    if (clips && !(pz_dot(s.across, at) <= PZ_AT(asphere + 1))) return pz_stopped(b, 3);
    found = settled && s.xi > 0.0f;
  }
  b.ray.at = s.at = at;
  r2 = at.x * at.x + at.y * at.y;
  if (!found) return pz_stopped(b, 1);
  PZ_BOOL open = r2 <= PZ_AT(surface + 6) && r2 >= PZ_AT(surface + 7);
  if (open && PZ_AT(surface + 9) != 0.0f) open = pz_within(PZ_P pz_whole(PZ_P PZ_EDGES), pz_xy(at.x, at.y));
  if (clips && !open) return pz_stopped(b, 3);
  s.nn = sphere ? 1.0f : pz_dot(s.g, s.g);
  s.k = s.mirror ? 0.0f : k;
  s.xo = s.mirror ? -s.xi : s.xi;
  s.gamma = (s.xo - s.xi) / s.nn;
  if (s.k != 0.0f) {
    d += k * s.nn;
    if (!(d >= 0.0f)) return pz_stopped(b, 2);
    s.xo = PZ_SQRT(d);
    s.gamma = k / (s.xo + s.xi);
  }
  b.ray.p = pz_xyz(p.x - s.gamma * s.g.x, p.y - s.gamma * s.g.y, p.z + s.gamma * s.g.z);
  if (s.mirror) b.ray.p = pz_times(-1.0f, b.ray.p);
  s.way += shift;
  for (int i = 0; i < 2 && follow; ++i) b.by[i] = pz_follow(b.by[i], s);
  return b;
}

/* Traces a ray in the lens frame through all surfaces, to the film or to the scene. */
PZ_FN pz_beam pz_trace(PZ_T pz_beam b, pz_light light, PZ_BOOL to_film, PZ_BOOL clips, PZ_BOOL follow) {
  int count = pz_whole(PZ_P PZ_SURFACE_COUNT), list = pz_whole(PZ_P PZ_SURFACES);
  int surface = list + (to_film ? 0 : count - 1) * PZ_SURFACE_SIZE;
  float n2 = pz_number(PZ_P light, to_film ? 4 : 4 + count), length;
  b.fate = 0;
  b.ray.at.z -= PZ_AT(surface);
  for (int j = 0; j < count; ++j) {
    int i = to_film ? j : count - 1 - j;
    float k = pz_number(PZ_P light, 5 + count + i);
    surface = list + i * PZ_SURFACE_SIZE;
    if (j > 0) b.ray.at.z -= to_film ? PZ_AT(surface - PZ_SURFACE_SIZE + 1) : -PZ_AT(surface + 1);
    float excess = pz_dot(b.ray.p, b.ray.p) - n2; /* refraction keeps it: p is too long by as much behind the surface */
    b = pz_pass(PZ_P b, surface, n2, to_film ? k : -k, clips, follow, PZ_FALSE);
    if (b.fate != 0) return b;
    n2 = pz_number(PZ_P light, to_film ? 5 + i : 4 + i);
    b.ray.p = pz_times(1.0f - 0.5f * excess / n2, b.ray.p);
  }
  length = pz_dot(b.ray.p, b.ray.p) / n2;
  if (!(pz_abs(length - 1.0f) < 1.2e-5f)) b.fate = 1;
  b.ray.p = pz_times(1.5f - 0.5f * length, b.ray.p);
  b.ray.at.z += PZ_AT(surface);
  return b;
}

/* ---- Rays by polynomials ---- */

/* Film and pupil point, scaled by the domain: film x, y, pupil x, y. Or a ray in object space as two vectors that turn
 * with it about the axis: the stereographic projection of the direction, and the foot of the perpendicular from the
 * reference point. Each is A f + B p, with f and p the film and pupil point, scaled, and polynomials A and B. */
PZ_STRUCT(pz_four) { float v[4]; };
PZ_FN pz_four pz_in_domain(PZ_T pz_point film, pz_point pupil) {
  pz_four x;
  x.v[0] = film.x / PZ_AT(PZ_DOMAIN);
  x.v[1] = film.y / PZ_AT(PZ_DOMAIN);
  x.v[2] = (pupil.x - PZ_AT(PZ_DOMAIN + 1) * film.x) / PZ_AT(PZ_DOMAIN + 2);
  x.v[3] = (pupil.y - PZ_AT(PZ_DOMAIN + 3) * film.y) / PZ_AT(PZ_DOMAIN + 4);
  return x;
}
PZ_FN pz_four pz_sums(PZ_T int w, pz_four x) {
  int n = (pz_whole(PZ_P PZ_DEGREE) - 1) / 2, list = pz_whole(PZ_P PZ_TERMS), at;
  PZ_BOOL two = PZ_AT(PZ_FILM_GRID + 4) > 0.0f;
  int terms = (n + 1) * (n + 2) * (n + 3) * (two ? n + 2 : 2) / 12, stride = two ? 2 * terms : terms;
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
PZ_FN float pz_scene_index(PZ_T pz_light light) { return PZ_SQRT(pz_number(PZ_P light, 4)); }
PZ_FN pz_beam pz_by_polynomial(PZ_T pz_light light, pz_point film, pz_point pupil) {
  pz_beam b;
  pz_four x = pz_in_domain(PZ_P film, pupil), c = pz_sums(PZ_P light.nearest, x);
  float square = c.v[0] * c.v[0] + c.v[1] * c.v[1], twice = 2.0f / (square + 1.0f);
  float along = twice * (c.v[0] * c.v[2] + c.v[1] * c.v[3]), p = twice * pz_scene_index(PZ_P light);
  b.ray.at = pz_xyz(c.v[2] - c.v[0] * along, c.v[3] - c.v[1] * along, along + PZ_AT(PZ_REFERENCE_Z));
  b.ray.p = pz_xyz(-p * c.v[0], -p * c.v[1], p * (1.0f - square) / 2.0f);
  b.fate = x.v[0] * x.v[0] + x.v[1] * x.v[1] <= 1.00001f && x.v[2] * x.v[2] + x.v[3] * x.v[3] <= 1.00001f ? 0 : 5;
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
/* The part of a ray behind the lens: its film point and a point of its pupil. */
PZ_STRUCT(pz_rear) {
  pz_light light;
  pz_point film;
  pz_pupil pupil;
  pz_pupil_sample to;
  int fate;
};
/* From a film point to a point in the plane of the pupil. */
PZ_FN pz_vector pz_to_pupil(PZ_T pz_point film, pz_point at) {
  return pz_xyz(at.x - film.x, at.y - film.y, PZ_AT(PZ_PUPIL_Z) - PZ_AT(PZ_FILM_Z));
}
PZ_FN pz_rear pz_rear_of(PZ_T float x, float y, float u, float v, float nm) {
  pz_rear s;
  float sound = (u + v) * 0.0f; /* NaN unless u and v are finite */
  s.light = pz_light_of(PZ_P nm);
  s.film = pz_xy(x, y);
  s.pupil = pz_find_pupil(PZ_P x, y, s.light.nearest < 0 ? 0 : s.light.nearest);
  s.to = pz_sample_pupil(PZ_P s.pupil, u, v);
  s.fate = !pz_on_film(PZ_P s.film) ? 6 : !(sound >= 0.0f) ? 3 : s.light.nearest < 0 ? 8 : s.to.area > 0.0f ? 0 : 3;
  return s;
}
PZ_FN pz_point pz_middle_after(PZ_T pz_cell c, float t, float s) {
  c.t += t;
  c.s += s;
  return pz_middle(PZ_P c);
}
/* The derivative of the middle of a pupil if the film point moves by df. */
PZ_FN pz_point pz_motion(PZ_T pz_rear s, pz_point df) {
  pz_cell c = s.pupil.cell;
  float per_mm = PZ_AT(PZ_ROWS_PER_MM), r = PZ_SQRT(s.film.x * s.film.x + s.film.y * s.film.y), turn = 0.0f;
  pz_point d = pz_to_grid(s.pupil, df), middle = pz_middle(PZ_P c);
  pz_point by_t = pz_plus(pz_middle_after(PZ_P c, 1.0f, 0.0f), -1.0f, middle);
  pz_point by_s = pz_plus(pz_middle_after(PZ_P c, 0.0f, 1.0f), -1.0f, middle);
  float dt = d.x * s.pupil.t_by_x + d.y * s.pupil.t_by_y, ds = d.y * per_mm;
  if (c.row == 0) turn = r * per_mm >= 1.0f ? middle.y / r : by_t.y * per_mm; /* polygons turn with the film point */
  return pz_to_film(s.pupil, pz_xy(turn * d.x + dt * by_t.x + ds * by_s.x, dt * by_t.y + ds * by_s.y));
}
/* The derivative of the ray of a start if the film point moves by df. Rays by polynomials: by central differences;
 * others: of pupil - film, less its part along the ray p. */
PZ_FN pz_line pz_moved(PZ_T pz_rear s, pz_vector p, pz_point df) {
  pz_line by;
  pz_point dp = pz_motion(PZ_P s, df);
  if (PZ_AT(PZ_RAYS) == 1.0f) {
    float h = 0.004f * PZ_AT(PZ_DOMAIN);
    pz_beam more = pz_by_polynomial(PZ_P s.light, pz_plus(s.film, h, df), pz_plus(s.to.at, h, dp));
    pz_beam less = pz_by_polynomial(PZ_P s.light, pz_plus(s.film, -h, df), pz_plus(s.to.at, -h, dp));
    by.at = pz_times(0.5f / h, pz_along(more.ray.at, -1.0f, less.ray.at));
    by.p = pz_times(0.5f / h, pz_along(more.ray.p, -1.0f, less.ray.p));
  } else {
    float per = p.z / (PZ_AT(PZ_PUPIL_Z) - PZ_AT(PZ_FILM_Z));
    by.at = pz_xyz(dp.x, dp.y, 0.0f);
    by.p = pz_xyz((dp.x - df.x) * per, (dp.y - df.y) * per, 0.0f);
    by.p = pz_along(by.p, -pz_dot(by.p, p) / pz_dot(p, p), p);
  }
  return by;
}
/* The ray of a start, in the plane where its model ends. follow: with derivatives */
PZ_FN pz_beam pz_leave(PZ_T pz_rear s, PZ_BOOL follow) {
  pz_beam b;
  b.fate = s.fate;
  if (s.fate != 0) return b;
  if (PZ_AT(PZ_RAYS) == 1.0f) {
    b = pz_by_polynomial(PZ_P s.light, s.film, s.to.at);
  } else {
    float n2 = pz_number(PZ_P s.light, 4 + pz_whole(PZ_P PZ_SURFACE_COUNT));
    pz_vector path = pz_to_pupil(PZ_P s.film, s.to.at);
    b.ray.at = pz_xyz(s.to.at.x, s.to.at.y, PZ_AT(PZ_PUPIL_Z));
    b.ray.p = pz_times((path.z < 0.0f ? -1.0f : 1.0f) * PZ_SQRT(n2 / pz_dot(path, path)), path);
  }
  for (int i = 0; i < 2 && follow; ++i)
    b.by[i] = pz_moved(PZ_P s, b.ray.p, i == 0 ? pz_xy(1.0f, 0.0f) : pz_xy(0.0f, 1.0f));
  if (PZ_AT(PZ_RAYS) == 0.0f) b = pz_trace(PZ_P b, s.light, PZ_FALSE, PZ_TRUE, follow);
  return b;
}
/* The camera ray of a start and its beam: with weight, and from the front of the lens. */
PZ_FN pz_ray pz_ray_of(PZ_T pz_rear s, pz_beam b) {
  pz_ray ray;
  pz_vector path = pz_to_pupil(PZ_P s.film, s.to.at);
  float factor = path.z / pz_dot(path, path);
  ray.origin = pz_xyz(0.0f, 0.0f, 0.0f);
  ray.direction = pz_xyz(0.0f, 0.0f, -1.0f);
  ray.weight = 0.0f;
  ray.pdf_pupil = s.fate == 0 ? 1.0f / s.to.area : 0.0f;
  ray.fate = b.fate;
  if (b.fate != 0) return ray;
  ray.origin = b.ray.at;
  ray.direction = pz_times(-1.0f / pz_scene_index(PZ_P s.light), b.ray.p);
  ray.weight = pz_number(PZ_P s.light, 0) * s.to.area * factor * factor;
  if (PZ_AT(PZ_RAYS) == 1.0f || PZ_AT(PZ_FRONT_FIRST) == 0.0f) {
    ray.origin = pz_along(ray.origin, pz_to_front(PZ_P ray.origin, ray.direction), ray.direction);
  }
  return ray;
}
/* A camera ray from a film point (mm), a pupil sample (u, v from 0 to 1) and a wavelength (nm). */
PZ_FN pz_ray pz_sample(PZ_T float film_x, float film_y, float u, float v, float nm) {
  pz_rear s = pz_rear_of(PZ_P film_x, film_y, u, v, nm);
  return pz_ray_of(PZ_P s, pz_leave(PZ_P s, PZ_FALSE));
}
/* The derivative of a ray whose origin stays on the front: N (at + t d_by + t_by d) = 0. Rays that graze a surface have
 * no finite derivatives: 0. at: the point of the derivative */
PZ_FN pz_line pz_on_front(PZ_T pz_ray ray, pz_vector at, pz_line by, pz_light light) {
  float c = PZ_AT(PZ_FRONT_CURVATURE);
  pz_vector o = ray.origin, d = ray.direction, normal = pz_xyz(c * o.x, c * o.y, c * (o.z - PZ_AT(PZ_FRONT_Z)) - 1.0f);
  if (!(ray.fate == 0 && pz_finite(pz_dot(by.p, by.p)))) {
    by.at = by.p = pz_xyz(0.0f, 0.0f, 0.0f);
    return by;
  }
  by.p = pz_times(-1.0f / pz_scene_index(PZ_P light), by.p);
  by.at = pz_along(by.at, pz_dot(pz_along(o, -1.0f, at), d), by.p);
  by.at = pz_along(by.at, -pz_dot(normal, by.at) / pz_dot(normal, d), d);
  return by;
}
/* The same ray with its derivatives by the film point, for texture filters. The offset of the pupil point from the
 * middle of the pupil is constant. */
PZ_FN pz_ray_differential pz_sample_differential(PZ_T float film_x, float film_y, float u, float v, float nm) {
  pz_rear s = pz_rear_of(PZ_P film_x, film_y, u, v, nm);
  pz_beam b = pz_leave(PZ_P s, PZ_TRUE);
  pz_ray_differential result;
  result.ray = pz_ray_of(PZ_P s, b);
  pz_line by_x = pz_on_front(PZ_P result.ray, b.ray.at, b.by[0], s.light);
  pz_line by_y = pz_on_front(PZ_P result.ray, b.ray.at, b.by[1], s.light);
  result.origin_by_x = by_x.at;
  result.direction_by_x = by_x.p;
  result.origin_by_y = by_y.at;
  result.direction_by_y = by_y.p;
  return result;
}

/* ---- From the scene to the film ---- */

PZ_FN pz_point pz_in_z_plane(pz_line ray, float z) {
  float to = (z - ray.at.z) / ray.p.z;
  return pz_xy(ray.at.x + to * ray.p.x, ray.at.y + to * ray.p.y);
}
/* A ray through the surfaces. It starts at a point near the lens. */
PZ_FN pz_rear pz_by_surfaces(PZ_T pz_line ray, pz_light light, PZ_BOOL clips) {
  pz_rear s;
  pz_beam b;
  b.ray = ray;
  b = pz_trace(PZ_P b, light, PZ_TRUE, clips, PZ_FALSE);
  s.film = pz_in_z_plane(b.ray, PZ_AT(PZ_FILM_Z));
  s.to.at = pz_in_z_plane(b.ray, PZ_AT(PZ_PUPIL_Z));
  s.fate = b.fate != 0 || pz_finite(s.film.x + s.film.y + s.to.at.x + s.to.at.y) ? b.fate : 1;
  return s;
}
/* The film and pupil point of a ray. The surfaces nearly invert polynomials: the points move by the distance at which
 * their ray by polynomials, through the surfaces, misses the points of the given ray. */
PZ_FN pz_rear pz_arrive(PZ_T pz_line ray, pz_light light) {
  PZ_BOOL exact = PZ_AT(PZ_RAYS) == 0.0f;
  pz_rear wanted = pz_by_surfaces(PZ_P ray, light, exact), s = wanted, found;
  float size = PZ_AT(PZ_DOMAIN), off = size;
  if (exact || wanted.fate != 0) return wanted;
  for (int i = 0; i < 8 && off > 1.0e-5f * size; ++i) {
    pz_beam b = pz_by_polynomial(PZ_P light, s.film, s.to.at);
    found = pz_by_surfaces(PZ_P b.ray, light, PZ_FALSE);
    if (found.fate != 0) return found;
    pz_point by_film = pz_plus(wanted.film, -1.0f, found.film), by_pupil = pz_plus(wanted.to.at, -1.0f, found.to.at);
    s.film = pz_plus(s.film, 1.0f, by_film);
    s.to.at = pz_plus(s.to.at, 1.0f, by_pupil);
    off = pz_abs(by_film.x) + pz_abs(by_film.y) + pz_abs(by_pupil.x) + pz_abs(by_pupil.y);
    s.fate = off < 1.0e-3f * size ? b.fate : 5;
  }
  return s;
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
  pz_line ray;
  float length2 = pz_dot(direction, direction), sound = pz_dot(origin, direction) * 0.0f, area;
  if (light.nearest < 0) return pz_dark(found.film, 8);
  if (!(sound >= 0.0f && pz_abs(length2 - 1.0f) < 1.0e-3f)) return pz_dark(found.film, 7);
  ray.at = pz_along(origin, -pz_dot(origin, direction), direction); /* the point nearest to the first vertex */
  ray.p = pz_times((1.5f - 0.5f * length2) * pz_scene_index(PZ_P light), direction);
  pz_rear s = pz_arrive(PZ_P ray, light);
  if (s.fate != 0) return pz_dark(found.film, s.fate);
  if (!pz_on_film(PZ_P s.film)) return pz_dark(s.film, 6);
  area = pz_area_at(PZ_P pz_find_pupil(PZ_P s.film.x, s.film.y, light.nearest), s.to.at);
  if (!(area > 0.0f)) return pz_dark(s.film, 3);
  pz_vector path = pz_to_pupil(PZ_P s.film, s.to.at);
  length2 = pz_dot(path, path);
  found.film = s.film;
  found.we = pz_number(PZ_P light, 1);
  found.pdf_film = 1.0f / (PZ_AT(PZ_FILM_WIDTH) * PZ_AT(PZ_FILM_HEIGHT));
  found.pdf_pupil = 1.0f / area;
  area = pz_number(PZ_P light, 3);
  found.pdf_position = area < 3.0e38f ? 1.0f / area : 1.0f; /* a pupil at infinity has no position */
  found.pdf_direction = pz_number(PZ_P light, 2) * length2 * length2 * found.pdf_pupil / found.pdf_position;
  return found;
}

/* The pupil of a scene point: a polygon in the plane through the centre that faces the point. Nodes lie over field (one
 * angle for a lens of revolution, two angles with cylinders) and reciprocal distance. */
PZ_STRUCT(pz_scene) {
  pz_pupil pupil;
  float distance;             /* from the centre */
  float solid;                /* solid angle of the ball that all rays meet, for near points without a polygon; or 0 */
  pz_vector ahead, right, up; /* unit: to the centre, and across */
};
PZ_FN pz_scene pz_find_scene(PZ_T pz_vector from, int w) {
  pz_scene s;
  int columns = pz_whole(PZ_P PZ_SCENE_GRID + 3), rows = pz_whole(PZ_P PZ_SCENE_GRID + 4), angles = rows > 0 ? 2 : 1;
  int layers = pz_whole(PZ_P PZ_SCENE_GRID + 5), widest = pz_whole(PZ_P PZ_WIDEST) + w * (layers + 1) * angles, layer;
  float z = from.z - PZ_AT(PZ_CENTRE_Z), r2 = from.x * from.x + from.y * from.y, r = PZ_SQRT(r2);
  float steepest = PZ_AT(PZ_STEEPEST), ball = PZ_AT(pz_whole(PZ_P PZ_BALLS) + w), per, sine, cosine, field;
  float azimuth_x = r2 > 0.0f ? from.x / r : 0.0f, azimuth_y = r2 > 0.0f ? from.y / r : 1.0f;
  pz_vector place = pz_xyz(0.0f, 0.0f, 0.0f);
  s.distance = PZ_SQRT(r2 + z * z);
  per = 1.0f / (s.distance > 0.0f ? s.distance : 1.0f);
  sine = r * per;
  cosine = -z * per;
  s.ahead = pz_xyz(-azimuth_x * sine, -azimuth_y * sine, cosine);
  s.right = pz_xyz(azimuth_y, -azimuth_x, 0.0f);
  s.up = pz_xyz(azimuth_x * cosine, azimuth_y * cosine, sine);
  s.pupil.x = pz_xy(1.0f, 0.0f);
  s.pupil.y = pz_xy(0.0f, 1.0f);
  s.pupil.flip = 1.0f;
  s.pupil.turn = s.pupil.t_by_x = s.pupil.t_by_y = 0.0f;
  PZ_BOOL near_lens = !(PZ_AT(widest) > 0.0f && steepest * s.distance >= 1.0f);
  field = 6.28318530718f * pz_turn_of(sine, cosine);
  place.x = field * PZ_FLOAT(columns);
  place.z = PZ_FLOAT(layers) * (per < steepest ? per / steepest : 1.0f);
  layer = pz_below(layers, place.z);
  widest += layer * angles;
  if (rows > 0) { /* along x and y, with mirror images */
    float sign_x = azimuth_x < 0.0f ? -1.0f : 1.0f, sign_y = azimuth_y < 0.0f ? -1.0f : 1.0f;
    s.pupil.x = pz_xy(sign_x * azimuth_y, sign_x * azimuth_x);
    s.pupil.y = pz_xy(-sign_y * azimuth_x, sign_y * azimuth_y);
    place.x *= pz_abs(azimuth_x);
    place.y = field * PZ_FLOAT(rows) * pz_abs(azimuth_y) / pz_linear(PZ_P widest + 1, 2, place.z - PZ_FLOAT(layer));
  }
  place.x /= pz_linear(PZ_P widest, angles, place.z - PZ_FLOAT(layer));
  s.pupil.cell = pz_cell_at(PZ_P PZ_SCENE_GRID, w, place);
  /* Rays of points in front of the lens may reach the pupil. */
  int surface = pz_whole(PZ_P PZ_SURFACES);
  float u = PZ_AT(surface + 4) * from.x * from.x + PZ_AT(surface + 5) * from.y * from.y;
  PZ_BOOL beside = r > PZ_AT(PZ_FRONT_HALF), sees = beside || from.z < pz_sag_of(PZ_P surface, u).z + PZ_AT(surface);
  sees = sees && ball > 0.0f && pz_finite(s.distance);
  s.pupil.known =
      sees && !near_lens && (beside || z < 0.0f) && place.x <= PZ_FLOAT(columns) && place.y <= PZ_FLOAT(rows);
  s.solid = 0.0f;
  if (sees && near_lens) {
    sine = ball * per;
    s.solid = sine < 1.0f ? 6.28318530718f * sine * sine / (1.0f + PZ_SQRT(1.0f - sine * sine)) : 12.5663706144f;
  }
  return s;
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
  pz_pupil_sample to = pz_sample_pupil(PZ_P s.pupil, u, v);
  if (to.area > 0.0f) {
    at = pz_along(pz_times(to.at.x, s.right), to.at.y, s.up);
    c.direction = pz_along(s.ahead, 1.0f / s.distance, at);
    float length = PZ_SQRT(pz_dot(c.direction, c.direction));
    c.direction = pz_times(1.0f / length, c.direction);
    c.distance = s.distance * length;
    c.pdf = length * c.distance / to.area * c.distance;
    at.z += PZ_AT(PZ_CENTRE_Z);
  } else {
    if (!(s.solid > 0.0f)) return c;
    float less = pz_clamped(v) * s.solid / 6.28318530718f; /* 1 - cosine of the angle to the centre */
    float sine = PZ_SQRT(less * (2.0f - less));
    pz_point turned = pz_circle(pz_clamped(u));
    c.direction = pz_along(pz_times(1.0f - less, s.ahead), sine * turned.y, s.right);
    c.direction = pz_along(c.direction, sine * turned.x, s.up);
    c.distance = less < 1.0f ? s.distance * (1.0f - less) : 0.0f;
    at = pz_along(from, c.distance, c.direction);
    c.pdf = 1.0f / s.solid;
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
  if (light.nearest < 0) return 0.0f;
  pz_scene s = pz_find_scene(PZ_P from, light.nearest);
  float cosine = pz_dot(direction, s.ahead), area;
  if (s.solid > 0.0f) return 1.0f - cosine <= s.solid / 6.28318530718f * 1.000001f ? 1.0f / s.solid : 0.0f;
  if (!(cosine > 0.0f)) return 0.0f;
  pz_vector met = pz_times(s.distance / cosine, direction); /* from the point to the plane */
  area = pz_area_at(PZ_P s.pupil, pz_xy(pz_dot(met, s.right), pz_dot(met, s.up)));
  return area > 0.0f ? s.distance / area * s.distance / (cosine * cosine * cosine) : 0.0f;
}

/* ---- Ghosts ---- */

/* The reflectances of an uncoated surface for s and p polarisation. p: in front of the surface; normal: of any length;
 * n2, k: as in pz_pass(). */
PZ_FN pz_point pz_reflectances(pz_vector p, pz_vector normal, float n2, float k) {
  float before = pz_dot(p, normal) * pz_dot(p, normal) / pz_dot(normal, normal), behind = before + k, s, t;
  if (k == 0.0f) return pz_xy(0.0f, 0.0f);
  if (!(behind > 0.0f)) return pz_xy(1.0f, 1.0f);
  before = PZ_SQRT(before);
  behind = PZ_SQRT(behind);
  s = (before - behind) / (before + behind);
  t = ((n2 + k) * before - n2 * behind) / ((n2 + k) * before + n2 * behind);
  return pz_xy(s * s, t * t);
}
/* Follows a ray of the scene, with unit direction into the lens, to the surface `second`, back to `first` and on to the
 * film. Surfaces count from 0, first < second; mirrors of the lens form no pairs (fate 7). Rims and iris clip at every
 * passage. The weight is the mean for s and p polarisation of the product of the reflectances and transmittances, with
 * uncoated surfaces, one plane of incidence for all surfaces, and glasses that absorb no light. */
PZ_FN pz_ghost pz_ghost_of(PZ_T pz_vector origin, pz_vector direction, int first, int second, float nm) {
  pz_ghost ghost;
  pz_light light = pz_light_of(PZ_P nm);
  pz_beam b;
  int count = pz_whole(PZ_P PZ_SURFACE_COUNT), list = pz_whole(PZ_P PZ_SURFACES), turns = 0, i = 0;
  float z = 0.0f, length2 = pz_dot(direction, direction), along = pz_dot(origin, direction);
  PZ_BOOL pair = first >= 0 && first < second && second < count && PZ_AT(list + first * PZ_SURFACE_SIZE + 8) == 0.0f &&
                 PZ_AT(list + second * PZ_SURFACE_SIZE + 8) == 0.0f;
  pz_point weight = pz_xy(1.0f, 1.0f), r;
  ghost.film = pz_xy(0.0f, 0.0f);
  ghost.weight = 0.0f;
  ghost.fate = light.nearest < 0 ? 8 : pair && pz_finite(along) && pz_abs(length2 - 1.0f) < 1.0e-3f ? 0 : 7;
  if (ghost.fate != 0) return ghost;
  b.ray.at = pz_along(origin, -along, direction);
  b.ray.p = pz_times((1.5f - 0.5f * length2) * pz_scene_index(PZ_P light), direction);
  b.fate = 0;
  while (i < count) {
    int surface = list + i * PZ_SURFACE_SIZE;
    PZ_BOOL reflects = turns < 2 && i == (turns == 0 ? second : first);
    float n2 = pz_number(PZ_P light, (turns == 1 ? 5 : 4) + i);
    float k = (turns == 1 ? -1.0f : 1.0f) * pz_number(PZ_P light, 5 + count + i);
    pz_vector p = b.ray.p;
    b.ray.at.z -= PZ_AT(surface) - z;
    z = PZ_AT(surface);
    b = pz_pass(PZ_P b, surface, n2, k, PZ_TRUE, PZ_FALSE, reflects);
    ghost.fate = b.fate;
    if (b.fate != 0) return ghost;
    r = pz_reflectances(p, pz_along(p, reflects ? 1.0f : -1.0f, b.ray.p), n2, k);
    weight = pz_xy(weight.x * (reflects ? r.x : 1.0f - r.x), weight.y * (reflects ? r.y : 1.0f - r.y));
    if (reflects) ++turns;
    i += turns == 1 ? -1 : 1;
  }
  b.ray.at.z += z;
  ghost.film = pz_in_z_plane(b.ray, PZ_AT(PZ_FILM_Z));
  ghost.fate = !pz_finite(ghost.film.x + ghost.film.y) ? 1 : pz_on_film(PZ_P ghost.film) ? 0 : 6;
  if (ghost.fate == 0) ghost.weight = 0.5f * (weight.x + weight.y);
  return ghost;
}

#endif /* PETZVAL_CAMERA_H */
