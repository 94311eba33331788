/* SPDX-License-Identifier: Apache-2.0 */
/* Rays of petzval_camera.h as C99 and as C++11. Prints sums over rays and connections, equal for all compilers that do
 * not contract products and sums, and with a third argument rays per second.
 *
 *   camera_table TABLE.bin NM [RAYS]
 */
#include "petzval/petzval_camera.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static unsigned state = 1;
static float number(void) { /* from 0 to 1 */
  state = state * 1664525u + 1013904223u;
  return (float)(state >> 8) / 16777216.0f;
}

int main(int argc, char** argv) {
  static float table[4 << 20];
  const float nm = argc > 2 ? (float)atof(argv[2]) : 0.0f;
  const long count = argc > 3 ? atol(argv[3]) : 20000;
  long lit = 0, connected = 0, i;
  double sums[4] = {0, 0, 0, 0};
  size_t size;
  FILE* file = argc > 2 ? fopen(argv[1], "rb") : NULL;
  clock_t begin;
  if (!file) {
    fprintf(stderr, "must be called as: camera_table TABLE.bin NM [RAYS]\n");
    return 2;
  }
  size = fread(table, sizeof table[0], sizeof table / sizeof table[0], file);
  fclose(file);
  if (!pz_valid(table, (int)size)) {
    fprintf(stderr, "%s: must be a complete table of format %d, made by petzval export LENS --camera FILE\n", argv[1],
            PZ_FORMAT);
    return 2;
  }
  begin = clock();
  for (i = 0; i < count; ++i) {
    const float column = number() * table[PZ_COLUMNS], row = number() * table[PZ_ROWS];
    const pz_point film = pz_film_point(table, column, row);
    const float u = number(), v = number();
    const pz_ray ray = pz_sample(table, film.x, film.y, u, v, nm);
    if (ray.fate != 0) continue;
    ++lit;
    sums[0] += (double)ray.direction.x + (double)ray.direction.y;
    sums[1] += (double)ray.weight;
    if (argc > 3) continue;
    {
      const pz_ray_differential by = pz_sample_differential(table, film.x, film.y, u, v, nm);
      const pz_connection c = pz_connect(table, pz_along(ray.origin, 700.0f, ray.direction), u, v, nm);
      sums[2] += (double)by.direction_by_x.x + (double)by.origin_by_y.y;
      sums[3] += (double)pz_pdf(table, pz_along(ray.origin, 700.0f, ray.direction), c.direction, nm);
      if (c.arrival.fate == 0) ++connected;
    }
  }
  printf("%ld rays, %ld connections: %.9g %.9g %.9g %.9g\n", lit, connected, sums[0], sums[1], sums[2], sums[3]);
  if (argc > 3) printf("%.2f million rays per second\n", 1e-6 * (double)count * CLOCKS_PER_SEC / (double)(clock() - begin));
  return lit > count / 2 ? 0 : 1;
}
