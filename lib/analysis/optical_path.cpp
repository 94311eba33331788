// SPDX-License-Identifier: Apache-2.0
#include "optical_path.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "petzval/paraxial/first_order.hpp"
#include "points.hpp"
#include "pupil/aim.hpp"
#include "trace/sequential.hpp"

namespace petzval::analysis_detail {

OpticalPaths::OpticalPaths(const Lens& lens, const PupilPlane& plane, std::size_t wavelength, const Vec3<double>& image)
    : lens_(lens), plane_(plane), wavelength_(wavelength), stop_(pupils(lens, wavelength).stop), image_(image) {
  const double semi_diameter = lens.surfaces()[stop_].semi_diameter;
  if (semi_diameter > 0 && std::isfinite(semi_diameter)) stop_unit_ = semi_diameter;
  for (std::size_t space = 0; space <= lens.surface_count(); ++space) indices_.push_back(lens.index(space, wavelength));
}

/// Signed distance from the wavefront through the centre of the pupil plane to a position near it, mm.
double OpticalPaths::to_pupil(const Vec3<double>& position) const noexcept {
  // |v - t / r| - 1 / r with unit vector t and reciprocal distance r, without cancellation of large distances.
  const Vec3<double> v = position - plane_.centre();
  const double r = plane_.reciprocal_distance(), along = glm::dot(v, plane_.towards()), squared = glm::dot(v, v);
  return (r * squared - 2 * along) / (std::sqrt(1 - 2 * r * along + r * r * squared) + 1);
}

std::optional<PathRay> OpticalPaths::operator()(const Ray<double>& ray) const noexcept {
  using Vec = kernel::Vec<double>;
  PathRay result;
  Vec from = kernel::to_kernel(ray.origin);
  double path = indices_[0] * to_pupil(ray.origin);
  std::size_t space = 0;
  const auto end = kernel::trace(
      kernel::view<double>(lens_), from, kernel::to_kernel(ray.direction),
      {.wavelength = wavelength_, .apertures = false}, [&](int surface, const Vec& hit, const Vec& direction) {
        const Vec step = hit - from;
        // Virtual segments run against the ray and count as negative.
        path += indices_[space++] * std::copysign(std::sqrt(dot(step, step)), dot(step, direction));
        from = hit;
        if (static_cast<std::size_t>(surface) == stop_) {
          result.stop = {hit.x / stop_unit_, hit.y / stop_unit_};
        }
      });
  const double forwards = lens_.light_direction(lens_.surface_count()) * end.direction.z;
  if (end.fate != RayFate::transmitted || !(forwards > 0)) return {};
  const Vec3<double> beyond = kernel::to_public(end.origin) - image_;
  result.direction = kernel::to_public(end.direction);
  const double along = glm::dot(beyond, result.direction);
  result.path = path - film_index() * along;
  const Vec3<double> miss = beyond - result.direction * along;
  result.miss_squared = glm::dot(miss, miss);
  result.film = Vec2<double>(beyond) - Vec2<double>(result.direction) * (beyond.z / result.direction.z);
  return result;
}

std::optional<SphereErrors> SphereErrors::of(const Lens& lens, const FieldPoint& point, std::size_t wavelength) {
  const PupilPlane plane(lens, point);
  const AimedRay chief = pupil_detail::aim(lens, plane, {}, wavelength);
  const auto image = chief_point(lens, point, wavelength);
  if (!chief || !image) return {};
  SphereErrors result(OpticalPaths(lens, plane, wavelength, {image->x, image->y, lens.film_z()}), *image,
                      lens.wavelengths_nm()[wavelength] * 1e-6);
  const auto centre = result.paths_(chief.ray);
  if (!centre) return {};
  // Along the chief ray from the plane of the exit pupil; positive if light passes the exit pupil before the film.
  const double exit_z = pupils(lens, wavelength, main_meridian(lens)).exit.z;
  result.radius_ = (lens.film_z() - exit_z) / centre->direction.z;
  result.reference_ = result.to_sphere(*centre);
  return result;
}

/// From the plane wavefront through the image point back to the sphere about it, less its radius.
double SphereErrors::to_sphere(const PathRay& ray) const noexcept {
  const double q2 = ray.miss_squared;
  return ray.path + paths_.film_index() * q2 / (radius_ * (1 + std::sqrt(std::max(0.0, 1 - q2 / (radius_ * radius_)))));
}

}  // namespace petzval::analysis_detail
