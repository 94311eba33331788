/* SPDX-License-Identifier: Apache-2.0 */
#ifndef PETZVAL_H
#define PETZVAL_H
/**
 * @file
 * Lenses and cameras for renderers, in C99, C++11 and later. Link petzval::c (libpetzval-c).
 *
 * Status: most functions return a petzval_status. On failure, results are set to 0 or NULL, fates to
 * PETZVAL_FATE_INVALID, and petzval_message() gives the reason. No exception leaves a function.
 *
 * Structs: petzval_film_init() and similar functions return structs with their `size` set and all other members 0. A
 * member of 0 has the default in its comment. Later versions only add members at the end, so that programs compiled
 * with an older header keep working. Structs without `size` never change.
 *
 * Memory: handles are freed by their own free function, which accepts NULL. Texts and arrays belong to the caller.
 * Structs and handles keep no pointers to memory of the caller.
 *
 * Threads: all functions may be called from any thread. Different handles are independent. Several threads may use one
 * handle, except in functions with `_set_` or `_free` in their names, and except a petzval_blur. A camera is
 * independent of the lens from which it was made.
 *
 * Units: the lens frame is right-handed and in mm: origin at the first vertex, light from the scene travels towards
 * +z. Rays, points and densities of a camera are in the frame and unit of petzval_camera_options. Raster position
 * (0, 0) is the upper left corner of the upright picture, (columns, rows) the lower right corner.
 */
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if defined(__GNUC__) && !defined(_WIN32)
#define PETZVAL_C_API __attribute__((visibility("default")))
#else
#define PETZVAL_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Version of this interface: it grows by 1 when something is added. */
#define PETZVAL_C_VERSION 1

typedef struct petzval_glasses petzval_glasses;     /**< a set of glasses */
typedef struct petzval_lens petzval_lens;           /**< a compiled lens with its stop, iris and focus */
typedef struct petzval_camera petzval_camera;       /**< a lens, a film and a ray model */
typedef struct petzval_lens_rays petzval_lens_rays; /**< rays of a camera through layers, for all pixels */
typedef struct petzval_layers petzval_layers;       /**< a scene as surfaces with colour and depth for each pixel */
typedef struct petzval_blur petzval_blur;           /**< memory of petzval_gather() */

/** Result of a call. */
typedef int32_t petzval_status;
enum {
  PETZVAL_OK = 0,
  PETZVAL_BAD_ARGUMENT = 1, /**< a null pointer, an unknown value, a struct of a wrong size, a version too new */
  PETZVAL_BAD_HANDLE = 2,   /**< a null handle, or a freed one (detected reliably if the library has assertions) */
  PETZVAL_REFUSED = 3,      /**< a file, lens or value that cannot be used; petzval_message() gives the rule */
  PETZVAL_OUT_OF_MEMORY = 4,
  PETZVAL_NOT_BUILT = 5, /**< the library was built without this part */
  PETZVAL_TOO_SMALL = 6, /**< the buffer is too small; `length`, if given, is the size that it needs */
  PETZVAL_CANCELLED = 7  /**< a callback of the caller asked to cancel */
};

/** @return PETZVAL_OK if the library has the interface that this header declares. Pass PETZVAL_C_VERSION. */
PETZVAL_C_API petzval_status petzval_check_version(int32_t version);
/** @return the message of the last failure on this thread, never NULL; valid until the next failure on this thread. */
PETZVAL_C_API const char* petzval_message(void);
/** @return the folder with lenses/ and glass/ of the installed library, or NULL if it is not found. */
PETZVAL_C_API const char* petzval_data_directory(void);

/* ---- glasses --------------------------------------------------------------------------------------------------- */

typedef struct petzval_glass {
  size_t size;
  char catalogue[32], name[64];
  double nd, vd;                  /**< as printed in the catalogue */
  double shortest_nm, longest_nm; /**< range of the dispersion formula */
} petzval_glass;

/**
 * Makes a set of glasses: the glasses of `base` (NULL: the installed tables) and the glasses of a file.
 *
 * Glasses of the file take precedence. Formats: .agf, a page of refractiveindex.info, the library's CSV.
 *
 * - file: path in UTF-8, or NULL for no file
 */
PETZVAL_C_API petzval_status petzval_glasses_create(const char* file, const petzval_glasses* base,
                                                    petzval_glasses** glasses);
PETZVAL_C_API void petzval_glasses_free(petzval_glasses* glasses);
/** @return the number of glasses; 0 for a bad handle */
PETZVAL_C_API size_t petzval_glasses_count(const petzval_glasses* glasses);
PETZVAL_C_API petzval_status petzval_glasses_get(const petzval_glasses* glasses, size_t index, petzval_glass* glass);

/* ---- lenses ---------------------------------------------------------------------------------------------------- */

typedef struct petzval_lens_options {
  size_t size;
  const double* wavelengths_nm; /**< wavelengths to compile; NULL: only the reference wavelength of the lens */
  size_t wavelength_count;
  double primary_nm; /**< a compiled wavelength; 0: the reference wavelength if compiled, else that near d */
  const petzval_glasses* glasses; /**< NULL: the installed tables */
  int32_t clamp_wavelengths;      /**< 1: outside the range of a glass, take the index at its end; 0: refuse */
  int32_t require_glasses;        /**< 1: refuse media without a known glass; 0: they follow n_d and V_d
                                     (PETZVAL_TEXT_MISSING_GLASS) */
  int32_t configuration;          /**< of a zoom lens, from 1; 0: the first */
  int32_t strict;                 /**< 1: refuse files that need an assumption; 0: list it as PETZVAL_TEXT_WARNING */
  const char* entry;              /**< lens of a lentil database; NULL: the only one */
} petzval_lens_options;

typedef struct petzval_lens_info {
  size_t size;
  double focal_length_mm; /**< infinite for an afocal lens; as all lengths below at the primary wavelength */
  double f_number;        /**< of the exact marginal ray; NaN if the lens has no stop */
  double film_z_mm, rear_focal_z_mm, front_principal_z_mm, rear_principal_z_mm;
  double entrance_pupil_z_mm, entrance_pupil_diameter_mm; /**< paraxial; NaN if the lens has no stop */
  double exit_pupil_z_mm, exit_pupil_diameter_mm;
  double declared_half_field_deg; /**< NaN if the lens declares none */
  double declared_f_number;       /**< NaN if the lens declares none */
  double image_diagonal_mm;       /**< declared; NaN if the lens declares none */
  double squeeze;                 /**< 1 unless the lens is anamorphic */
  int64_t surface_count, wavelength_count, primary_wavelength;
  int64_t stop;       /**< surface from 0; -1 if none is marked */
  double index_error; /**< bound of the error of indices between compiled wavelengths; may be infinite */
  int32_t has_cylinders, has_moving_groups;
} petzval_lens_info;

typedef struct petzval_surface {
  size_t size;
  double vertex_z_mm, thickness_mm, curvature, conic; /**< curvature in 1/mm */
  double semi_diameter_mm;                            /**< above 1e15: unlimited */
  double index_before, index_after;                   /**< at the primary wavelength */
  int32_t mirror, aspheric_terms, stop;
  int32_t section; /**< 0: a surface of revolution; 1: curved along x only; 2: curved along y only */
} petzval_surface;

enum {
  PETZVAL_TEXT_NAME = 0,          /**< name of the lens */
  PETZVAL_TEXT_WARNING = 1,       /**< assumptions of the reader of the file */
  PETZVAL_TEXT_CLAMPED_GLASS = 2, /**< glasses that do not cover all wavelengths */
  PETZVAL_TEXT_MISSING_GLASS = 3, /**< media without a catalogue glass */
  PETZVAL_TEXT_PRESCRIPTION = 4   /**< the lens as JSON, as petzval_lens_parse() reads it */
};

/** Origins of distances. */
enum { PETZVAL_FROM_FRONT_VERTEX = 0, PETZVAL_FROM_FILM = 1, PETZVAL_FROM_ENTRANCE_PUPIL = 2 };

/** Reads a lens from a file of any format that the library knows (petzval JSON, Zemax, CODE V, OSLO, ...). */
PETZVAL_C_API petzval_status petzval_lens_read(const char* file, const petzval_lens_options* options,
                                               petzval_lens** lens);
/** Reads a lens from memory. `name` is the source in messages. */
PETZVAL_C_API petzval_status petzval_lens_parse(const char* bytes, size_t count, const char* name,
                                                const petzval_lens_options* options, petzval_lens** lens);
PETZVAL_C_API petzval_status petzval_lens_copy(const petzval_lens* lens, petzval_lens** copy);
PETZVAL_C_API void petzval_lens_free(petzval_lens* lens);
PETZVAL_C_API petzval_status petzval_lens_get_info(const petzval_lens* lens, petzval_lens_info* info);
PETZVAL_C_API petzval_status petzval_lens_get_surface(const petzval_lens* lens, size_t index, petzval_surface* surface);
/**
 * Copies a text, with its final 0, to a buffer.
 *
 * - kind: PETZVAL_TEXT_...
 * - index: position in a list, from 0; at the end of the list the length is 0
 * - text: may be NULL if capacity is 0
 * - length: bytes that the text needs, with its final 0; may be NULL
 */
PETZVAL_C_API petzval_status petzval_lens_get_text(const petzval_lens* lens, int32_t kind, size_t index, char* text,
                                                   size_t capacity, size_t* length);
/**
 * Copies a report of the lens as JSON, with a final 0, to a buffer: first-order data, pupils and aberrations for a
 * subject at the distance in focus, or, if none was set, at the object distance of the lens file. lib/docs/reports.md
 * lists the keys (`report`). The report takes up to seconds, without fields milliseconds; 1 MiB holds the report of
 * three fields and wavelengths.
 *
 * - fields_deg: field angles towards +y, seen from the entrance pupil; may be NULL if count is 0
 * - threads: 0: 1
 * - text, length: as in petzval_lens_get_text()
 */
PETZVAL_C_API petzval_status petzval_lens_report(const petzval_lens* lens, const double* fields_deg, size_t count,
                                                 int32_t threads, char* text, size_t capacity, size_t* length);
/** Stops the lens down, from its widest opening: f/2 is refused for a lens that opens to f/2.8. */
PETZVAL_C_API petzval_status petzval_lens_set_f_number(petzval_lens* lens, double f_number);
/**
 * Gives the stop blades.
 *
 * - blades: 3 to 20; 0: round
 * - roundness: 0: straight edges; 1: round
 * - rotation: angle of the first corner from +y (rad)
 */
PETZVAL_C_API petzval_status petzval_lens_set_iris(petzval_lens* lens, int32_t blades, double roundness,
                                                   double rotation);
/** Focuses by exact rays. The distance may be infinite; `origin` is PETZVAL_FROM_... */
PETZVAL_C_API petzval_status petzval_lens_set_focus(petzval_lens* lens, double distance_mm, int32_t origin);

/* ---- films and focus points ------------------------------------------------------------------------------------ */

typedef struct petzval_film {
  size_t size;
  double width_mm, height_mm;    /**< 0: 36 and 24 */
  int32_t columns, rows;         /**< pixels; 0: 1920 and 1280 */
  double shift_x_mm, shift_y_mm; /**< film point at the centre of the rectangle */
  double margin_mm;              /**< around the rectangle, for filters and overscan */
  double tilt_rad, swing_rad;    /**< rotations about x and y of the lens frame */
  double z_mm;                   /**< used if has_z is 1 */
  int32_t has_z, unused;         /**< has_z 0: the film of the lens */
} petzval_film;

typedef struct petzval_focus_point {
  double position_mm[3]; /**< lens frame */
  double blur_mm;        /**< signed diameter that the point shall have; 0: sharp */
  double weight;         /**< relative to the other points */
} petzval_focus_point;

typedef struct petzval_film_fit {
  size_t size;
  double rms_mm;            /**< weighted RMS of blur minus requested blur */
  int32_t limited, upright; /**< the tilt reached its limit; the points do not determine a tilt */
} petzval_film_fit;

/**
 * Moves and tilts a film so that focus points get their blurs, by exact rays.
 *
 * - max_tilt_rad: 0: the film stays upright; else 0.35 is usual
 * - film: on input the size and pixels, on output also position, tilt and shift; unchanged on failure
 * - fit: may be NULL
 */
PETZVAL_C_API petzval_status petzval_lens_fit_film(const petzval_lens* lens, const petzval_focus_point* points,
                                                   size_t count, double max_tilt_rad, petzval_film* film,
                                                   petzval_film_fit* fit);

/* ---- models ---------------------------------------------------------------------------------------------------- */

/** Requirements of a scene for a ray model. */
typedef struct petzval_requirements {
  size_t size;
  double near_mm, far_mm;  /**< depths from the film; 0: 1000 and infinity */
  double max_px;           /**< largest error of a ray in pixels; 0: no limit */
  double max_of_blur;      /**< or as a fraction of the blur; 0: no limit */
  double exposure;         /**< largest error of the irradiance, as a fraction; 0: no limit */
  double pupil_shape;      /**< largest error of the pupil area, as a fraction; 0: 0.1 */
  int32_t threads, unused; /**< 0: 1 */
} petzval_requirements;

typedef struct petzval_choice {
  size_t size;
  char model[32];                       /**< the cheapest model within the limits, for petzval_camera_options */
  double max_px, exposure, pupil_shape; /**< its measured errors */
  double ns_per_ray;                    /**< in batches, on this machine */
  char reasons[1024];                   /**< one line per reason */
} petzval_choice;

/** Chooses the cheapest ray model whose errors stay within the requirements. The lens must be focused. */
PETZVAL_C_API petzval_status petzval_lens_choose_model(const petzval_lens* lens, const petzval_film* film,
                                                       const petzval_requirements* requirements,
                                                       petzval_choice* choice);

/* ---- cameras --------------------------------------------------------------------------------------------------- */

/** Frames of rays and points. */
enum {
  PETZVAL_FRAME_LENS = 0,    /**< right-handed; the scene is at -z */
  PETZVAL_FRAME_PBRT = 1,    /**< left-handed: +x right, +y up, view along +z; also Cycles */
  PETZVAL_FRAME_MITSUBA = 2, /**< right-handed: +x left, +y up, view along +z */
  PETZVAL_FRAME_ARNOLD = 3   /**< right-handed: +x right, +y up, view along -z; also appleseed */
};
enum { PETZVAL_IRRADIANCE = 0, PETZVAL_UNITY_ON_AXIS = 1, PETZVAL_UNITY_AT_EACH_WAVELENGTH = 2 };

typedef struct petzval_camera_options {
  size_t size;
  const char* model;         /**< "exact_float" (NULL), "exact_double", "thin", "thick", "polynomial_7", ... */
  int32_t normalisation;     /**< PETZVAL_IRRADIANCE, ... */
  int32_t frame;             /**< PETZVAL_FRAME_... */
  int32_t origin;            /**< of the frames of hosts: PETZVAL_FROM_... */
  int32_t threads;           /**< of the set-up; 0: 1. The result is the same for every number. */
  double units_per_mm;       /**< 1e-15 to 1e15; 0: 1 for the lens frame, 0.1 for Arnold, else 0.001 (metres) */
  int32_t clamp_wavelengths; /**< 1: samples outside the compiled range use its end; 0: they are lost */
  int32_t importance_tables; /**< 1: made now; 0: by the first call from the scene side, which then takes longer */
  double near_mm, far_mm;    /**< subject distances for petzval_camera_set_focus(); 0 and 0: the focus is fixed */
  int32_t near_far_origin;   /**< PETZVAL_FROM_...; also of petzval_camera_set_focus() */
  int32_t keep_light;        /**< 1: the second rim keeps the exposure */
  double lens_ratio;         /**< second rim that clips pupils, in radii of the pupil; 0: none */
  double rate_of_change;     /**< its displacement at the edge of the film */
  double weight_distribution, weight_strength; /**< bokeh: weights over the stop; 0: even */
} petzval_camera_options;

typedef struct petzval_camera_info {
  size_t size;
  char model[32];
  double film_width_mm, film_height_mm, film_z_mm, film_area_mm2; /**< film_z_mm: as the shutter opens */
  int32_t columns, rows;
  double units_per_mm;
  double shortest_nm, longest_nm; /**< compiled range */
  int64_t wavelength_count;
} petzval_camera_info;

enum {
  PETZVAL_FATE_TRANSMITTED = 0,
  PETZVAL_FATE_MISSED_SURFACE = 1,
  PETZVAL_FATE_TOTALLY_REFLECTED = 2,
  PETZVAL_FATE_VIGNETTED = 3,
  PETZVAL_FATE_NO_CONVERGENCE = 4,
  PETZVAL_FATE_OUTSIDE_FIT = 5,
  PETZVAL_FATE_OUTSIDE_FILM = 6,
  PETZVAL_FATE_INVALID = 7, /**< a number is not finite, or a direction is no unit vector */
  PETZVAL_FATE_OUTSIDE_SPECTRUM = 8
};

/** A sample of the film. Numbers that are not finite give a lost ray, except `time`: NaN counts as 0. */
typedef struct petzval_sample {
  double raster_x, raster_y;
  double pupil_u, pupil_v; /**< in the unit square */
  double wavelength_nm;    /**< 0: the primary wavelength */
  double time;             /**< 0 to 1 while the shutter is open */
} petzval_sample;

/** A ray to the scene. The mean of weight * radiance over a pixel is its irradiance; lost rays have weight 0. */
typedef struct petzval_ray {
  double origin[3], direction[3]; /**< on the front of the lens; unit vector */
  double weight;                  /**< sr for PETZVAL_IRRADIANCE */
  double pdf_film, pdf_pupil;     /**< on the film and in the pupil plane, in 1/mm^2 for every unit of the camera */
  double pdf_direction;           /**< at the film, 1/sr */
  int32_t fate, unused;           /**< PETZVAL_FATE_... */
} petzval_ray;

/** A ray and its change to the next pixel to the right (x) and below (y). */
typedef struct petzval_ray_differential {
  petzval_ray ray;
  double origin_by_x[3], direction_by_x[3], origin_by_y[3], direction_by_y[3];
} petzval_ray_differential;

/** Arrays of N samples and rays, in float or double; the members with "or NULL" may be left out. */
typedef struct petzval_samples_float {
  const float *raster_x, *raster_y, *pupil_u, *pupil_v;
  const float* wavelengths_nm; /**< or NULL: all rays have the primary wavelength */
  const float* times;          /**< or NULL: 0 */
} petzval_samples_float;
typedef struct petzval_rays_float {
  float *x, *y, *z, *dx, *dy, *dz, *weights;
  uint8_t* fates;                   /**< or NULL */
  float *pdf_pupil, *pdf_direction; /**< or NULL */
} petzval_rays_float;
typedef struct petzval_samples_double {
  const double *raster_x, *raster_y, *pupil_u, *pupil_v;
  const float* wavelengths_nm;
  const double* times;
} petzval_samples_double;
typedef struct petzval_rays_double {
  double *x, *y, *z, *dx, *dy, *dz, *weights;
  uint8_t* fates;
  double *pdf_pupil, *pdf_direction;
} petzval_rays_double;

/** Importance of a ray from the scene, for light tracing. Areas are in the unit of the camera, squared. */
typedef struct petzval_importance {
  double raster_x, raster_y;
  double we;            /**< 1/area; 0 if the ray does not arrive */
  double pdf_position;  /**< times pdf_direction: density of this ray among film samples, in the measure cos dA dw */
  double pdf_direction; /**< 1/sr */
  int32_t fate, unused;
} petzval_importance;

/** A connection from a scene point to the lens. */
typedef struct petzval_connection {
  double direction[3]; /**< unit, to the lens */
  double distance;     /**< infinite for distant light */
  double on_front[3];  /**< end of the shadow ray */
  double pdf;          /**< 1/sr, for distant light 1/area; 0 if there is no connection */
  petzval_importance importance;
} petzval_connection;

/** The part of a path at one of several wavelengths. */
typedef struct petzval_path_wavelength {
  double raster_x, raster_y; /**< intersection of the ray with the film at this wavelength */
  double weight;             /**< for the mean of weight * radiance; the densities of all wavelengths are combined */
  double density;            /**< of this ray among film samples of this wavelength */
  int32_t fate, unused;
} petzval_path_wavelength;

/** Makes a camera. `film` and `options` may be NULL. */
PETZVAL_C_API petzval_status petzval_camera_create(const petzval_lens* lens, const petzval_film* film,
                                                   const petzval_camera_options* options, petzval_camera** camera);
PETZVAL_C_API void petzval_camera_free(petzval_camera* camera);
PETZVAL_C_API petzval_status petzval_camera_get_info(const petzval_camera* camera, petzval_camera_info* info);
/**
 * Changes the focus of a camera made for a range of distances (near_mm, far_mm), without new tables.
 *
 * - opens_mm, closes_mm: distances as the shutter opens and closes; equal for a fixed focus
 */
PETZVAL_C_API petzval_status petzval_camera_set_focus(petzval_camera* camera, double opens_mm, double closes_mm);
/**
 * Writes the set-up of a camera as JSON: prescription, glasses, settings. Another process with the same version of the
 * library makes the same camera from it, whose rays are equal to the bit on a processor with the same instruction sets.
 * Set-ups in reports of the program petzval are read as well; they name lens files, which are then opened.
 *
 * - bytes: may be NULL if capacity is 0
 * - length: bytes that the set-up needs; may be NULL
 */
PETZVAL_C_API petzval_status petzval_camera_write(const petzval_camera* camera, char* bytes, size_t capacity,
                                                  size_t* length);
PETZVAL_C_API petzval_status petzval_camera_read(const char* bytes, size_t count, petzval_camera** camera);

PETZVAL_C_API petzval_status petzval_camera_sample(const petzval_camera* camera, const petzval_sample* sample,
                                                   petzval_ray* ray);
PETZVAL_C_API petzval_status petzval_camera_sample_differential(const petzval_camera* camera,
                                                                const petzval_sample* sample,
                                                                petzval_ray_differential* ray);
PETZVAL_C_API petzval_status petzval_camera_sample_float(const petzval_camera* camera, size_t count,
                                                         const petzval_samples_float* samples,
                                                         const petzval_rays_float* rays);
PETZVAL_C_API petzval_status petzval_camera_sample_double(const petzval_camera* camera, size_t count,
                                                          const petzval_samples_double* samples,
                                                          const petzval_rays_double* rays);
/**
 * Samples the ray of one wavelength and evaluates it at all wavelengths of a path (hero wavelengths).
 *
 * The hero is nm[0]. It must be distributed so that each wavelength could have been the hero with the same set: for
 * example equal steps through the spectrum, wrapped at its ends.
 *
 * - nm: wavelengths; sample->wavelength_nm is not used
 * - found: one result for each wavelength
 */
PETZVAL_C_API petzval_status petzval_camera_sample_path(const petzval_camera* camera, const petzval_sample* sample,
                                                        size_t count, const double* nm, petzval_ray* ray,
                                                        petzval_path_wavelength* found);
/**
 * Importance of N rays that travel towards the lens: reverse the direction of a camera ray.
 *
 * - origins, directions: 3 N numbers each; any points of the lines, and unit vectors
 * - nm, times: N values; NULL: the primary wavelength, and time 0
 */
PETZVAL_C_API petzval_status petzval_camera_importance(const petzval_camera* camera, size_t count,
                                                       const double* origins, const double* directions, const float* nm,
                                                       const double* times, petzval_importance* found);
/** Samples connections from N points (3 N numbers) to the lens. `u` and `v` lie in the unit square. */
PETZVAL_C_API petzval_status petzval_camera_connect(const petzval_camera* camera, size_t count, const double* points,
                                                    const double* u, const double* v, const float* nm,
                                                    const double* times, petzval_connection* found);
/** Samples a connection with light from infinity. `direction` (3 numbers) is the direction of travel. */
PETZVAL_C_API petzval_status petzval_camera_connect_distant(const petzval_camera* camera, const double* direction,
                                                            double u, double v, double nm, double time,
                                                            petzval_connection* found);
/**
 * Density with which the connect functions choose a ray.
 *
 * - distant: 0: 1/sr at the point, as petzval_camera_connect(); 1: 1/area across the direction
 */
PETZVAL_C_API petzval_status petzval_camera_connection_pdf(const petzval_camera* camera, const double* point,
                                                           const double* direction, double nm, int32_t distant,
                                                           double* pdf);
/**
 * Raster positions of the chief rays of N points.
 *
 * - points: 3 N numbers
 * - raster: 2 N numbers, also outside the picture; NaN if there is no chief ray near the film
 * - visible: N values, or NULL; 1 if the chief ray passes and meets the film
 */
PETZVAL_C_API petzval_status petzval_camera_project(const petzval_camera* camera, size_t count, const double* points,
                                                    double nm, double time, double* raster, uint8_t* visible);

typedef struct petzval_psf_options {
  size_t size;
  uint32_t samples;     /**< rays for each wavelength; 0: 2^18 */
  int32_t pixels;       /**< columns and rows of the image; 0: 64 */
  double half_width_mm; /**< half the width of the image; 0: the blur fits */
  double centre_mm[2];  /**< film point of its centre, used if has_centre is 1 */
  int32_t has_centre;   /**< 0: the centroid */
  int32_t threads;      /**< 0: 1 */
  uint32_t seed;
  int32_t distant; /**< 1: the light is at infinity, and `point` the direction towards it */
} petzval_psf_options;

typedef struct petzval_psf {
  size_t size;
  double pixel_mm, centre_mm[2], centroid_mm[2];
  double rms_radius_mm, max_radius_mm;
  double throughput; /**< fraction of the light on the paraxial entrance pupil that reaches the film */
  double error;      /**< bound of the relative error of the radial profile */
  int32_t pixels, wavelengths;
} petzval_psf;

/**
 * Image of a point light on the film.
 *
 * - point: 3 numbers; petzval_psf refers to the film in mm
 * - image: [wavelength][row][column], rows from +y of the film on, in fractions of the light on the entrance pupil;
 * NULL: only `psf` is filled
 * - floats: floats in `image`: at least wavelengths * pixels * pixels
 */
PETZVAL_C_API petzval_status petzval_camera_point_image(const petzval_camera* camera, const double* point,
                                                        const petzval_psf_options* options, petzval_psf* psf,
                                                        float* image, size_t floats);

typedef struct petzval_ghosts_options {
  size_t size;
  double film_reflectance; /**< 0 to 1; above 0, the film is the first mirror of more pairs */
  double tolerance;        /**< target for the relative error of energies; 0: 0.001 */
  int32_t most_pairs;      /**< pairs of the surfaces with the highest reflectances; 0: 2000 */
  int32_t distant;         /**< 1: the light is at infinity, and `point` the direction towards it */
  int32_t threads;         /**< 0: 1; results are the same for every number */
  int32_t unused;
} petzval_ghosts_options;

/** Light that the surface `second`, then the surface `first`, reflect towards the film. */
typedef struct petzval_ghost {
  int32_t first, second; /**< surfaces, counted from 0; the number of surfaces is the film */
  double energy;         /**< fraction of the light that enters the first surface within its rim */
  double error;          /**< relative, of `energy` */
  double centre_mm[2];   /**< on the film */
  double rms_radius_mm, peak_per_mm2;
  int32_t caustic, unused; /**< caustic: 1 if rays cross in a part of the ghost */
} petzval_ghost;

/**
 * Ghosts of a point of light, by exact rays for every camera.
 *
 * - point: 3 numbers in the frame of the camera
 * - pairs: the brightest pairs at the primary wavelength, at most `capacity`; NULL: none
 * - count: number of all pairs; NULL: not wanted
 * - picture: [wavelength][row][column], rows from the top of the upright picture: irradiances for a light whose
 * irradiance at the front vertex, across the beam, is 1; NULL: none
 * - floats: floats in `picture`: at least wavelengths * rows * columns
 */
PETZVAL_C_API petzval_status petzval_ghosts(const petzval_camera* camera, const double* point,
                                            const petzval_ghosts_options* options, petzval_ghost* pairs,
                                            size_t capacity, size_t* count, float* picture, size_t floats);

/* ---- lens blur of layers --------------------------------------------------------------------------------------- */

/**
 * Options of lens rays. Depths are along the lens axis, from the pinhole in the middle of the entrance pupil. Rows
 * begin at the top of the upright picture; colours are linear, unlimited and premultiplied by alpha. A picture has the
 * pixels of the film. Layers have as many, or extend beyond the picture equally on all sides (overscan).
 */
typedef struct petzval_lens_rays_options {
  size_t size;
  int32_t count;        /**< rays of a pixel; 0: 100 */
  int32_t set_count;    /**< sets of rays that adjacent pixels alternate, for grain instead of patterns: 4, 16; 0: 1 */
  int32_t over_pixels;  /**< 1: rays start all over their pixel, for layers with a sample per pixel; 0: at its centre */
  int32_t threads;      /**< 0: 1 */
  double nearest_mm;    /**< depth of the nearest surface; 0: the focal length of an image 24 mm high */
  const double* rgb_nm; /**< red, green and blue, which the lens covers; NULL: the primary wavelength */
} petzval_lens_rays_options;

typedef struct petzval_lens_rays_info {
  size_t size;
  double focal_px, axis_px[2];   /**< a point (x, y, depth), y up, is seen at axis + focal (x, -y) / depth */
  double pinhole_z_mm;           /**< lens frame */
  double reach_px, offset_px;    /**< largest distance of rays beyond the picture, and of a ray from its pixel */
  double bias;                   /**< 1/mm: surfaces nearer to the one in front, in inverse depth, are hidden */
  int32_t columns, rows;         /**< of the picture */
  int32_t overscan, most_layers; /**< of layers in which rays miss no surface */
} petzval_lens_rays_info;

typedef struct petzval_gather_options {
  size_t size;
  int32_t left, top, columns, rows; /**< pixels to compute, with the bits of the whole picture; all 0: the whole */
  int32_t threads, unused;          /**< 0: 1; the picture is the same for every number */
  double highlights_above;          /**< surfaces brighter than this become smooth discs; 0: 1; infinity: none */
  /** NULL, or called by the caller's thread with the fraction done and `user` after each tile of 64 x 16 pixels.
     Returns 1 to cancel. */
  int32_t (*progress)(double, void*);
  void* user;
} petzval_gather_options;

/**
 * Tabulates the rays of a camera with a fixed focus. `options` may be NULL. The weights follow the normalisation of the
 * camera: with PETZVAL_UNITY_ON_AXIS a picture keeps its brightness.
 */
PETZVAL_C_API petzval_status petzval_lens_rays_create(const petzval_camera* camera,
                                                      const petzval_lens_rays_options* options,
                                                      petzval_lens_rays** rays);
PETZVAL_C_API void petzval_lens_rays_free(petzval_lens_rays* rays);
/** Facts for scenes between two depths. farthest_mm may be infinite. */
PETZVAL_C_API petzval_status petzval_lens_rays_get_info(const petzval_lens_rays* rays, double nearest_mm,
                                                        double farthest_mm, petzval_lens_rays_info* info);
/**
 * Makes layers from 1 to 64 images, from near to far. Refuses depths out of order, and alpha outside 0 to 1.
 *
 * - rgba, depth_mm: for each image 4 and 1 floats per pixel; depths: infinity: the sky; 0, negative or NaN: empty
 */
PETZVAL_C_API petzval_status petzval_layers_create(int32_t columns, int32_t rows, size_t count,
                                                   const float* const* rgba, const float* const* depth_mm,
                                                   petzval_layers** layers);
/**
 * Makes layers from deep samples of 5 floats (depth in mm, red, green, blue, alpha), in any order.
 *
 * - offsets: columns x rows + 1; pixel p has the samples offsets[p] to offsets[p + 1] - 1 of `count`
 * - bias, most_layers: of petzval_lens_rays_info; 1 to 64: surfaces behind are dropped
 */
PETZVAL_C_API petzval_status petzval_layers_create_deep(int32_t columns, int32_t rows, const size_t* offsets,
                                                        const float* samples, size_t count, double bias,
                                                        int32_t most_layers, petzval_layers** layers);
PETZVAL_C_API void petzval_layers_free(petzval_layers* layers);
PETZVAL_C_API petzval_status petzval_blur_create(petzval_blur** blur);
PETZVAL_C_API void petzval_blur_free(petzval_blur* blur);
/**
 * Renders the picture of layers through a lens, or a region of it, to memory of the caller, which is only written if
 * the call succeeds. On one thread and without highlights, calls after the first of a size do not allocate.
 *
 * - options: may be NULL
 * - blur: memory that is reused; it also keeps the highlights of the last layers
 * - rgba, row_bytes: first pixel of the region, and distance of its rows; negative if the lowest row is first
 * - missed: columns x rows fractions of rays that met surfaces unknown to the layers; may be NULL
 */
PETZVAL_C_API petzval_status petzval_gather(const petzval_layers* layers, const petzval_lens_rays* rays,
                                            const petzval_gather_options* options, petzval_blur* blur, float* rgba,
                                            ptrdiff_t row_bytes, float* missed);

/* ---- initial values of structs --------------------------------------------------------------------------------- */

/** petzval_film_init() and so on return a struct with `size` set and all other members 0. */
#define PETZVAL_INIT(type)               \
  static inline type type##_init(void) { \
    type value;                          \
    memset(&value, 0, sizeof value);     \
    value.size = sizeof value;           \
    return value;                        \
  }
PETZVAL_INIT(petzval_glass)
PETZVAL_INIT(petzval_lens_options)
PETZVAL_INIT(petzval_lens_info)
PETZVAL_INIT(petzval_surface)
PETZVAL_INIT(petzval_film)
PETZVAL_INIT(petzval_film_fit)
PETZVAL_INIT(petzval_requirements)
PETZVAL_INIT(petzval_choice)
PETZVAL_INIT(petzval_camera_options)
PETZVAL_INIT(petzval_camera_info)
PETZVAL_INIT(petzval_psf_options)
PETZVAL_INIT(petzval_psf)
PETZVAL_INIT(petzval_ghosts_options)
PETZVAL_INIT(petzval_lens_rays_options)
PETZVAL_INIT(petzval_lens_rays_info)
PETZVAL_INIT(petzval_gather_options)

#ifdef __cplusplus
}
#endif
#endif
