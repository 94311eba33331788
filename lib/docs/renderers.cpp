// SPDX-License-Identifier: Apache-2.0
// The code of renderers.md.
#include <iostream>
#include <petzval/petzval.hpp>

namespace {

using namespace petzval;

/// A scene for the examples: a uniform sky of radiance 1.
double radiance(const Ray<double>&) { return 1; }

void first_camera() {
  Lens lens = compile(read_prescription(data_directory() / "lenses/double_gauss_100mm_f2.0.json"));
  lens = with_f_number(lens, 2.8);
  lens = with_focus(lens, 3000, {.origin = DistanceOrigin::film});  // mm
  const Camera camera(lens, {.width_mm = 36, .height_mm = 24, .columns = 1920, .rows = 1280});

  const FilmPoint point = camera.film().point(960.5, 640.5);  // column, row
  const CameraRay r = camera.sample({.film = point, .pupil_u = 0.3, .pupil_v = 0.7});
  if (r) std::cout << "irradiance " << r.weight * radiance(r.ray) << '\n';
}

}  // namespace

int main() { first_camera(); }
