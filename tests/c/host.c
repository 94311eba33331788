/* SPDX-License-Identifier: Apache-2.0
   A renderer's calls of the C interface, compiled as C99 to C++17 (standards.sh). Prints numbers, which must be equal
   in all languages; the exit status is 1 if a call fails. */
#include <math.h>
#include <stdio.h>

#include "petzval/petzval.h"

static int failures = 0;
static void check(petzval_status status, const char* call) {
  if (status == PETZVAL_OK) return;
  printf("%s: %d: %s\n", call, (int)status, petzval_message());
  ++failures;
}
#define CHECK(call) check(call, #call)

int main(int count, char** arguments) {
  const double nm[4] = {450, 520, 590, 660};
  double total = 0;
  char name[64];
  int i;
  petzval_lens* lens = NULL;
  petzval_camera* camera = NULL;
  petzval_lens_options options = petzval_lens_options_init();
  petzval_film film = petzval_film_init();
  petzval_camera_options camera_options = petzval_camera_options_init();
  petzval_lens_info info = petzval_lens_info_init();
  petzval_ray_differential differential;
  petzval_path_wavelength path[4];
  petzval_connection connection;
  petzval_sample sample;
  petzval_ray ray;
  if (count < 2) return 2;
  memset(&sample, 0, sizeof sample);
  options.wavelengths_nm = nm;
  options.wavelength_count = 4;
  CHECK(petzval_check_version(PETZVAL_C_VERSION));
  CHECK(petzval_lens_read(arguments[1], &options, &lens));
  CHECK(petzval_lens_set_f_number(lens, 2.8));
  CHECK(petzval_lens_set_focus(lens, 3000, PETZVAL_FROM_FILM));
  CHECK(petzval_lens_get_info(lens, &info));
  CHECK(petzval_lens_get_text(lens, PETZVAL_TEXT_NAME, 0, name, sizeof name, NULL));
  film.columns = 300;
  film.rows = 200;
  camera_options.frame = PETZVAL_FRAME_PBRT;
  camera_options.origin = PETZVAL_FROM_FILM;
  CHECK(petzval_camera_create(lens, &film, &camera_options, &camera));
  petzval_lens_free(lens);
  for (i = 0; i < 1000; ++i) {
    sample.raster_x = i % 300;
    sample.raster_y = i % 199;
    sample.pupil_u = (i + 0.5) / 1000;
    sample.pupil_v = fmod(i * 0.61803398875, 1);
    sample.wavelength_nm = 450 + i % 200;
    CHECK(petzval_camera_sample(camera, &sample, &ray));
    CHECK(petzval_camera_sample_differential(camera, &sample, &differential));
    CHECK(petzval_camera_sample_path(camera, &sample, 4, nm, &ray, path));
    CHECK(petzval_camera_connect(camera, 1, ray.origin, &sample.pupil_u, &sample.pupil_v, NULL, NULL, &connection));
    total += ray.weight + differential.direction_by_x[0] + path[1].weight;
  }
  petzval_camera_free(camera);
  printf("%s %.6f %.17g\n", name, info.focal_length_mm, total);
  if (petzval_camera_sample(NULL, &sample, &ray) != PETZVAL_BAD_HANDLE) ++failures;
  return failures != 0;
}
