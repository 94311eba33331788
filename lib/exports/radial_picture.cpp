// SPDX-License-Identifier: Apache-2.0
#include "radial_picture.hpp"

#include <algorithm>
#include <cmath>

#include "camera/lens_facts.hpp"
#include "core/low_discrepancy.hpp"
#include "petzval/core/error.hpp"
#include "petzval/exports/distortion.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::exports_detail {
namespace {

/// Direction from the centre of the picture to its upper right corner: to the right and up.
Vec2<double> unit_corner(const Film& film) {
  const double length = std::hypot(film.columns, film.rows);
  return {film.columns / length, film.rows / length};
}

}  // namespace

std::optional<double> ChiefProfile::radius(double field) const {
  const Vec2<double> corner = unit_corner(camera_.film());
  const double across = distance_ * std::sin(field);
  const Vec3<double> point{across * corner.x, across * corner.y, pupil_z_ - distance_ * std::cos(field)};
  const Projection found = camera_.project(point, wavelength_);
  if (found.status == AimStatus::no_ray) return {};
  const Film& film = camera_.film();
  return corner.x * (found.raster.x - film.columns / 2.0) + corner.y * (film.rows / 2.0 - found.raster.y);
}

std::optional<double> ChiefProfile::field(double radius_px, double widest) const {
  double near = 0, far = widest;
  for (int i = 0; i < 60; ++i) {
    const double middle = (near + far) / 2;
    const auto found = radius(middle);
    (found && *found < radius_px ? near : far) = middle;
  }
  const auto found = radius(far);
  if (!found || std::abs(*found - radius_px) > 1e-3) return {};
  return far;
}

double irradiance(const Camera& camera, double radius_mm) {
  constexpr std::size_t count = 512;
  const Vec2<double> corner = unit_corner(camera.film());
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [u, v] = core_detail::fibonacci_point(i, count);
    sum += camera.sample({.film = {-radius_mm * corner.x, -radius_mm * corner.y}, .pupil_u = u, .pupil_v = v}).weight;
  }
  return sum / count;
}

RadialPicture::RadialPicture(const Camera& of, std::optional<double> subject_z_mm) : camera(of), primary(of, 0, 0, {}) {
  const Film& film = camera.film();
  const Lens& lens = camera.lens();
  const std::string where = lens.name() + ": calibration: ";
  if (camera_detail::has_cylinders(lens)) throw Error(where + "the lens has cylinders; must be a lens of revolution");
  if (film.tilted() || film.shift_x_mm != 0 || film.shift_y_mm != 0 || film.travel_mm != 0) {
    throw Error(where + "the film is tilted, shifted or travels; must be upright and fixed");
  }
  const double pixel = film.height_mm / film.rows;
  if (std::abs(film.width_mm / film.columns / pixel - 1) > 1e-6) throw Error(where + "pixels are not square; must be");
  const LensDistortion distortion(camera, subject_z_mm);
  pupil_z = distortion.pinhole().z_mm;
  distance = std::min(pupil_z - distortion.pinhole().subject_z_mm, 1e9);
  corner = std::hypot(film.columns, film.rows) / 2;
  primary = at({});
  for (double field = radians(0.5); field < radians(130); field += radians(0.5)) {
    const auto found = primary.radius(field);
    if (!found || !(*found > 0)) break;
    widest = field;
    if (*found > corner) break;
  }
}

}  // namespace petzval::exports_detail
