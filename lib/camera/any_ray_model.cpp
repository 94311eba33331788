// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "camera/ray_model.hpp"

namespace petzval {

RayFate AnyRayModel::Interface::batch_of_one(const TwoPlaneRay& film_ray, Wavelength wavelength,
                                             Ray<double>& ray) const noexcept {
  const auto& [film_x, film_y, pupil_x, pupil_y] = film_ray;
  auto& [o, d] = ray;
  RayFate fate = RayFate::missed_surface;
  to_scene(1, TwoPlaneRays<const double>{&film_x, &film_y, &pupil_x, &pupil_y}, {.all = wavelength},
           RayArrays<double>{&o.x, &o.y, &o.z, &d.x, &d.y, &d.z}, &fate);
  return fate;
}

RayDerivatives AnyRayModel::Interface::differences(const TwoPlaneRayDerivatives& film_ray,
                                                   Wavelength wavelength) const noexcept {
  // Relative to the distance between the planes: the truncation error is the square of this step, rounding eps / step.
  constexpr double relative_step = 1e-5;
  const double h = relative_step * std::abs(pupils->space().depth());
  const auto moved = [&](const TwoPlaneRay& by, double step) -> TwoPlaneRay {
    const TwoPlaneRay& l = film_ray.line;
    return {l.film_x + step * by.film_x, l.film_y + step * by.film_y, l.pupil_x + step * by.pupil_x,
            l.pupil_y + step * by.pupil_y};
  };
  RayDerivatives result;
  result.fate = to_scene(film_ray.line, wavelength, result.ray);
  std::array<Ray<double>, 4> rays;
  const bool all = to_scene(moved(film_ray.by_u, -h), wavelength, rays[0]) == RayFate::transmitted &&
                   to_scene(moved(film_ray.by_u, h), wavelength, rays[1]) == RayFate::transmitted &&
                   to_scene(moved(film_ray.by_v, -h), wavelength, rays[2]) == RayFate::transmitted &&
                   to_scene(moved(film_ray.by_v, h), wavelength, rays[3]) == RayFate::transmitted;
  if (result.fate != RayFate::transmitted || !all) return result;
  const auto slope = [&](const Ray<double>& before, const Ray<double>& after) -> Ray<double> {
    return {(after.origin - before.origin) / (2 * h), (after.direction - before.direction) / (2 * h)};
  };
  result.by_u = slope(rays[0], rays[1]);
  result.by_v = slope(rays[2], rays[3]);
  return result;
}

}  // namespace petzval
