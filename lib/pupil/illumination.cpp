// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/illumination.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "core/meet_plane.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"
#include "pupil/pupil_boundary.hpp"
#include "pupil_nodes.hpp"
#include "pupil_region.hpp"

namespace petzval {

double film_irradiance(const Lens& lens, const FilmPoint& point, Wavelength wavelength) {
  const bool axially_symmetric = point.x == 0 && point.y == 0 && lens.rotationally_symmetric();
  const auto seen = [&](std::size_t directions) {
    return pupil_detail::pupil_in_angles(lens, point, wavelength, directions);
  };
  PupilRegion region = seen(axially_symmetric ? 1 : 256);
  // A pupil with several spans in one direction is rare; it needs more directions.
  const bool disconnected = !region.empty() && region.spans.size() != region.directions;
  if (disconnected && !axially_symmetric) region = seen(1024);
  if (region.empty()) return 0;
  // A small area at the angle t from the normal has a projected solid angle of sin t cos t / t times the area.
  double sum = 0;
  pupil_detail::for_each_node<16>(region, [&](const Vec2<double>& angles, double area, double weight) {
    const double angle = glm::length(angles);
    sum += weight * area * (angle > 0 ? std::sin(2 * angle) / (2 * angle) : 1);
  });
  const double n = lens.index(lens.surface_count(), wavelength);
  return pupil_detail::area_of(region, n * n * sum);
}

double image_circle_mm(const Lens& lens, double least_fraction, Wavelength wavelength) {
  if (!(least_fraction >= 0 && least_fraction <= 1)) {
    throw Error(lens.name() + ": image circle: least_fraction = " + to_text(least_fraction) + "; must be 0 to 1");
  }
  const double axis = film_irradiance(lens, {}, wavelength), min_irradiance = least_fraction * axis;
  if (axis == 0) return 0;
  const std::size_t directions = lens.rotationally_symmetric() ? 1 : 8;
  const auto lit = [&](double radius) {
    for (std::size_t k = 0; k < directions; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(directions);
      const FilmPoint point{radius * std::sin(angle), radius * std::cos(angle)};
      // 16 directions suffice to detect a pupil.
      const bool bright = least_fraction > 0 ? film_irradiance(lens, point, wavelength) >= min_irradiance
                                             : !pupil_detail::pupil_in_angles(lens, point, wavelength, 16).empty();
      if (!bright) return false;
    }
    return true;
  };
  const FirstOrder data = first_order(lens, wavelength, main_meridian(lens, wavelength));
  const double last_z = lens.surfaces().back().vertex_z;
  const double scale = data.afocal ? std::abs(lens.film_z() - last_z) : std::abs(data.effective_focal_length);
  double low = 0, step = scale / 10;
  while (lit(low + step)) {
    low += step;
    if (low > scale) step *= 2;
    if (low > 500 * scale) return std::numeric_limits<double>::infinity();
  }
  for (double high = low + step; high - low > 1e-4 / 2 * scale;) {
    const double middle = (low + high) / 2;
    (lit(middle) ? low : high) = middle;
  }
  return 2 * low;
}

std::optional<double> relative_illumination(const Lens& lens, const FieldPoint& point, Wavelength wavelength) {
  if (lens.film_z() == lens.surfaces().back().vertex_z) return {};  // no plane separates directions of its light
  const double axis = film_irradiance(lens, {}, wavelength);
  const AimedRay chief = chief_ray(lens, point, wavelength);
  if (axis == 0 || !chief || !chief.end.transmitted()) return {};
  const Vec3<double> image = core_detail::meet_plane(chief.end.ray, lens.film_z());
  return film_irradiance(lens, {image.x, image.y}, wavelength) / axis;
}

Film default_film(const Lens& lens, std::optional<double> diagonal_mm, double largest_mm) {
  constexpr double least_fraction = 0.1;
  const double diagonal = diagonal_mm ? *diagonal_mm : std::min(image_circle_mm(lens, least_fraction), largest_mm);
  if (!(diagonal > 0 && std::isfinite(diagonal))) {
    throw Error(lens.name() + ": film: the " +
                (diagonal_mm ? "declared image diagonal = "
                             : "prescription declares no image diagonal and the image circle = ") +
                to_text(diagonal) + " mm; must be finite and above 0");
  }
  const double unit = diagonal / std::hypot(3.0, 2.0);
  return {.width_mm = 3 * unit, .height_mm = 2 * unit, .columns = 1920, .rows = 1280};
}

}  // namespace petzval
