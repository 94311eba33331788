// SPDX-License-Identifier: Apache-2.0
// Newton's form of imaging, from the focal points: with Z = z - F before the lens and Z' = z' - F' behind it
//
//     Z Z' = -f f',   x' = x f / Z,   y' = y f / Z,
//
// which maps planes to planes, the ends included: Z = 0 goes to infinity, infinity to Z' = 0. A point at infinity is
// its direction with the fourth coordinate 0.
#include "petzval/movement/ideal_lens.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::inline v0 {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Unit normal with z >= 0.
std::optional<Plane> plane(const Vec3<double>& normal, double offset) {
  const double length = std::hypot(normal.x, normal.y, normal.z) * (normal.z < 0 ? -1 : 1);
  const Plane result{normal / length, offset / length};
  if (length == 0 || !std::isfinite(result.offset) || !std::isfinite(glm::dot(result.normal, result.normal))) return {};
  return result;
}

FirstOrder focusing(const Lens& lens, Wavelength wavelength, Meridian meridian) {
  const FirstOrder data = first_order(lens, wavelength, meridian);
  if (data.afocal) throw Error(lens.name() + ": ideal lens: it has no focal length, wanted one");
  if (data.image_index < 0) {
    throw Error(lens.name() + ": ideal lens: light leaves it towards -z, wanted it towards +z");
  }
  return data;
}

}  // namespace

std::optional<ImagePoint> IdealLens::image(const ScenePoint& place) const noexcept {
  Vec3<double> p = place.position;
  double w = place.at_infinity ? 0 : 1;
  if (p.z == -infinity && std::isfinite(p.x) && std::isfinite(p.y)) p = {0, 0, -1}, w = 0;
  const double from_focus = p.z - w * front_focal_z, f = front_focal_length, f_rear = rear_focal_length;
  if (!(from_focus < 0) || !(p.z < w * front_z)) return {};
  ImagePoint result;
  result.position = {p.x / from_focus * f, p.y / from_focus * f, rear_focal_z - f * (w / from_focus) * f_rear};
  if (const Pupil& in = pupils.entrance; std::isfinite(in.z)) {
    const double to_pupil = w * in.z - p.z, angular = (in.z - front_focal_z) / f_rear;
    result.slope_x = -(p.x / to_pupil) * angular;
    result.slope_y = -(p.y / to_pupil) * angular;
    result.cone = std::abs(in.diameter / f_rear * (from_focus / to_pupil));
  } else {
    const double from_pupil = result.position.z - pupils.exit.z;
    result.slope_x = result.position.x / from_pupil;
    result.slope_y = result.position.y / from_pupil;
    result.cone = std::abs(pupils.exit.diameter / from_pupil);
  }
  const Vec3<double>& i = result.position;
  const bool finite = std::isfinite(i.x + i.y + i.z) && std::isfinite(result.slope_x + result.slope_y + result.cone);
  if (!finite) return {};
  return result;
}

ScenePoint IdealLens::scene_of(const Vec3<double>& image) const noexcept {
  const double from_focus = image.z - rear_focal_z;
  if (from_focus == 0) return {{-image.x / front_focal_length, -image.y / front_focal_length, -1}, true};
  // x = x' Z / f, without Z.
  const double by = -rear_focal_length / from_focus;
  return {{by * image.x, by * image.y, front_focal_z + by * front_focal_length}, false};
}

double IdealLens::growth(double film_z, double before) const noexcept {
  if (std::isinf(pupils.exit.z)) return 0;
  return before == pupils.exit.z ? std::nan("") : (film_z - before) / (before - pupils.exit.z);
}

std::optional<Plane> IdealLens::image_of(const Plane& scene) const noexcept {
  const Vec3<double>& n = scene.normal;
  const double along = scene.offset - n.z * front_focal_z;
  return plane({rear_focal_length * n.x, rear_focal_length * n.y, along},
               along * rear_focal_z - n.z * front_focal_length * rear_focal_length);
}

std::optional<Plane> IdealLens::scene_of(const Plane& film) const noexcept {
  const Vec3<double>& m = film.normal;
  const double along = m.z * rear_focal_z - film.offset;
  return plane({front_focal_length * m.x, front_focal_length * m.y, along},
               along * front_focal_z + m.z * front_focal_length * rear_focal_length);
}

IdealLens thin_lens(double focal_length, double f_number, double z) {
  if (!std::isfinite(focal_length) || focal_length == 0) {
    throw Error("thin_lens: focal length is " + number(focal_length) + " mm, wanted a finite one other than 0");
  }
  if (!(f_number > 0)) throw Error("thin_lens: f-number is " + number(f_number) + ", wanted one above 0");
  if (!std::isfinite(z)) throw Error("thin_lens: z is " + number(z) + " mm, wanted a finite place");
  const Pupil pupil{z, std::abs(focal_length) / f_number};
  return {z - focal_length, z + focal_length, focal_length, focal_length, {pupil, pupil}, z, z};
}

IdealLens thin_lens(const Lens& lens, Wavelength wavelength) {
  const Meridian meridian = main_meridian(lens, wavelength);
  const FirstOrder data = focusing(lens, wavelength, meridian);
  const double z = data.rear_principal_z, front = data.object_index / data.power, rear = data.image_index / data.power;
  const Pupil pupil{z, petzval::pupils(lens, wavelength, meridian).entrance.diameter};
  return {z - front, z + rear, front, rear, {pupil, pupil}, z, z};
}

IdealLens thick_lens(const Lens& lens, Wavelength wavelength) {
  const Meridian meridian = main_meridian(lens, wavelength);
  const FirstOrder data = focusing(lens, wavelength, meridian);
  return {data.front_focal_z,
          data.rear_focal_z,
          data.object_index / data.power,
          data.image_index / data.power,
          petzval::pupils(lens, wavelength, meridian),
          lens.surfaces().front().vertex_z,
          lens.surfaces().back().vertex_z};
}

double signed_blur(const ImagePoint& image, const Film& film) {
  const Vec3<double> n = film.normal(), to_film = Vec3<double>(0, 0, film.z()) - image.position;
  return image.cone * glm::dot(n, to_film) / (n.z + n.x * image.slope_x + n.y * image.slope_y);
}

std::optional<FilmPoint> chief_point(const ImagePoint& image, const Film& film) {
  const Vec3<double> n = film.normal(), along{image.slope_x, image.slope_y, 1};
  const double by = glm::dot(n, Vec3<double>(0, 0, film.z()) - image.position) / glm::dot(n, along);
  if (!std::isfinite(by)) return {};
  return film.point(image.position + by * along);
}

std::optional<FocusPlane> focus_plane(const IdealLens& lens, const Film& film) {
  const std::optional<Plane> plane = lens.scene_of(film.plane());
  if (!plane) return {};
  return FocusPlane{*plane, line_at(*plane, lens.front_focal_z), line_at(*plane, lens.front_principal_z())};
}

}  // namespace petzval::inline v0
