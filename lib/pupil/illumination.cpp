// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/illumination.hpp"

#include <cmath>
#include <numbers>

#include "core/meet_plane.hpp"
#include "core/quadrature.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/pupil/pupil_boundary.hpp"

namespace petzval::inline v0 {

double film_irradiance(const Lens& lens, const FilmPoint& point, Wavelength wavelength) {
  const PupilPlane plane = PupilPlane::of_film(lens, point);
  const bool alike_all_round = plane.on_axis() && lens.rotationally_symmetric();
  const PupilBoundary boundary =
      alike_all_round ? exit_pupil_boundary(lens, point, wavelength, 1) : exit_pupil_boundary(lens, point, wavelength);
  // Part dA of the plane, gap away from the film, is seen in the projected solid angle cos^4 dA / gap^2. The
  // nodes lie in the squared radius, of which equal steps are equal areas.
  const double gap = plane.towards().z / plane.reciprocal_distance();
  const auto nodes = core_detail::gauss_legendre<3>();
  double sum = 0;
  for (const PupilSpan& span : boundary.spans) {
    const double from = span.from_radius * span.from_radius, to = span.to_radius * span.to_radius;
    for (const auto& [node, weight] : nodes) {
      const Vec2<double> p = boundary.at(span.direction, std::sqrt(from + node * (to - from)));
      const double cosine = plane.ray(p.x, p.y).direction.z;
      sum += weight * (to - from) * std::pow(cosine, 4);
    }
  }
  if (sum == 0) return 0;
  const double n = lens.index(lens.surface_count(), wavelength);
  return n * n * sum * std::numbers::pi / static_cast<double>(boundary.directions) * boundary.half_axes[0] *
         boundary.half_axes[1] / (gap * gap);
}

std::optional<double> relative_illumination(const Lens& lens, const FieldPoint& point, Wavelength wavelength) {
  const double axis = film_irradiance(lens, {}, wavelength);
  const AimedRay chief = chief_ray(lens, point, wavelength);
  if (axis == 0 || !chief || !chief.end.transmitted()) return {};
  const Vec3<double> image = core_detail::meet_plane(chief.end.ray, lens.film_z());
  return film_irradiance(lens, {image.x, image.y}, wavelength) / axis;
}

}  // namespace petzval::inline v0
