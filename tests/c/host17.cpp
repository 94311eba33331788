// SPDX-License-Identifier: Apache-2.0
// Calls of the classes of petzval17.hpp, compiled as C++11 to C++17 without exceptions (standards.sh).
#include "petzval/petzval17.hpp"

#include <cstdio>

int main(int count, char** arguments) {
  if (count < 2) return 2;
  petzval17::Lens lens = petzval17::Lens::read(arguments[1]);
  lens.f_number(2.8).focus(3000);
  const petzval17::Lens wide = lens.copy();
  petzval17::Camera camera(lens);
  const petzval17::Camera again = petzval17::Camera::read(camera.write());
  if (!lens || !wide || !camera || !again) return 1;
  petzval_sample sample = petzval_sample();
  sample.raster_x = 700, sample.raster_y = 400, sample.pupil_u = 0.3, sample.pupil_v = 0.6;
  const petzval_ray ray = camera.sample(sample), same = again.sample(sample);
  if (!(ray.weight > 0) || ray.weight != same.weight || ray.direction[0] != same.direction[0]) return 1;
  const double reversed[3] = {-ray.direction[0], -ray.direction[1], -ray.direction[2]};
  const petzval_importance found = camera.importance(ray.origin, reversed);
  std::printf("%s: %.3f %.3f\n", lens.text(PETZVAL_TEXT_NAME).c_str(), found.raster_x, found.raster_y);
  if (!(found.we > 0) || found.raster_x < 699.9 || found.raster_x > 700.1) return 1;
  petzval17::Lens missing = petzval17::Lens::read("missing.json");
  missing.f_number(4);
  petzval17::Camera none(missing);
  if (missing || none || none.status() != PETZVAL_REFUSED || none.message().find("missing.json") == std::string::npos) {
    return 1;
  }
  petzval17::Lens refused = lens.copy();
  refused.focus(5);
  const petzval17::Camera of_refused(refused), empty((petzval17::Lens()));
  if (of_refused || of_refused.message().empty() || empty || empty.sample(sample).fate != PETZVAL_FATE_INVALID)
    return 1;
  if (camera.set_focus(1000, 1000) || !camera) return 1;
  petzval17::Camera moved = std::move(camera);
  return moved && moved.info().columns == 1920 ? 0 : 1;
}
