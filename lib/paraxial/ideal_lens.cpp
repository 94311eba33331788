// SPDX-License-Identifier: Apache-2.0
// Newton's equations, with distances from the focal points: Z = z - F for the object and Z' = z' - F' for the image,
//
//     Z Z' = -f f',   x' = x f / Z,   y' = y f / Z.
//
// The equations map planes to planes, even at infinity: Z = 0 maps to infinity and infinity to Z' = 0. A point at
// infinity is a direction, with the fourth coordinate 0.
#include "petzval/paraxial/ideal_lens.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "core/meet_plane.hpp"
#include "core/text.hpp"
#include "focal_points.hpp"
#include "paraxial/marginal_ray.hpp"
#include "petzval/core/error.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The plane with a unit normal, normal.z >= 0; nullopt if it lies at infinity or a number is not finite.
std::optional<Plane> plane(const Vec3<double>& normal, double offset) {
  const double length = std::hypot(normal.x, normal.y, normal.z) * (normal.z < 0 ? -1 : 1);
  const Plane result{normal / length, offset / length};
  if (length == 0 || !std::isfinite(result.offset) || !std::isfinite(glm::dot(result.normal, result.normal))) return {};
  return result;
}

}  // namespace

double IdealLens::object_at_separation(double separation) const noexcept {
  // The larger root of p + product / p = sum, factored so that squares do not overflow and no digits cancel near the
  // turning point, where sum is twice the root of the product.
  const double turning = 2 * std::sqrt(std::abs(product())), sum = separation - (rear_focal_z - front_focal_z);
  if (product() < 0) return (sum + std::hypot(sum, turning)) / 2;
  const double reached = std::max(sum, turning);
  return (reached + std::sqrt(reached - turning) * std::sqrt(reached + turning)) / 2;
}

std::optional<ImagePoint> IdealLens::image(const ScenePoint& point) const noexcept {
  Vec3<double> at = point.position;
  double w = point.at_infinity ? 0 : 1;
  if (at.z == -infinity && std::isfinite(at.x) && std::isfinite(at.y)) at = {0, 0, -1}, w = 0;
  const double from_focus = at.z - w * front_focal_z, f = front_focal_length, f_rear = rear_focal_length;
  if (!(from_focus < 0) || !(at.z < w * front_z)) return {};
  ImagePoint result;
  result.position = {at.x / from_focus * f, at.y / from_focus * f, rear_focal_z - product() * (w / from_focus)};
  if (const Pupil& in = pupils.entrance; std::isfinite(in.z)) {
    const double to_pupil = w * in.z - at.z, angular = (in.z - front_focal_z) / f_rear;
    result.slope_x = -(at.x / to_pupil) * angular;
    result.slope_y = -(at.y / to_pupil) * angular;
  } else {
    const double from_pupil = result.position.z - pupils.exit.z;
    result.slope_x = result.position.x / from_pupil;
    result.slope_y = result.position.y / from_pupil;
  }
  result.diameter_per_mm = 2 * std::abs(marginal_ray(*this, w == 0 ? infinity : -from_focus).slope);
  const Vec3<double>& i = result.position;
  const bool finite =
      std::isfinite(i.x + i.y + i.z) && std::isfinite(result.slope_x + result.slope_y + result.diameter_per_mm);
  if (!finite) return {};
  return result;
}

ScenePoint IdealLens::scene_of(const Vec3<double>& image) const noexcept {
  const double from_focus = image.z - rear_focal_z;
  if (from_focus == 0) return {{-image.x / front_focal_length, -image.y / front_focal_length, -1}, true};
  // x = x' Z / f = -x' f' / Z'.
  const double by = -rear_focal_length / from_focus;
  return {{by * image.x, by * image.y, front_focal_z + by * front_focal_length}, false};
}

double IdealLens::magnification_change(double film_z, double before) const noexcept {
  if (std::isinf(pupils.exit.z)) return 0;
  return before == pupils.exit.z ? std::nan("") : (film_z - before) / (before - pupils.exit.z);
}

std::optional<Plane> IdealLens::image_of(const Plane& scene) const noexcept {
  const Vec3<double>& n = scene.normal;
  const double along = scene.offset - n.z * front_focal_z;
  return plane({rear_focal_length * n.x, rear_focal_length * n.y, along}, along * rear_focal_z - n.z * product());
}

std::optional<Plane> IdealLens::scene_of(const Plane& film) const noexcept {
  const Vec3<double>& m = film.normal;
  const double along = m.z * rear_focal_z - film.offset;
  return plane({front_focal_length * m.x, front_focal_length * m.y, along}, along * front_focal_z + m.z * product());
}

namespace paraxial_detail {

IdealLens focal_points(const Lens& lens, const FirstOrder& data) noexcept {
  IdealLens result;
  result.front_focal_z = data.front_focal_z;
  result.rear_focal_z = data.rear_focal_z;
  result.front_focal_length = data.object_index / data.power;
  result.rear_focal_length = data.image_index / data.power;
  result.front_z = lens.surfaces().front().vertex_z;
  result.rear_z = lens.surfaces().back().vertex_z;
  return result;
}

}  // namespace paraxial_detail

IdealLens thin_lens(double focal_length, double f_number, double z) {
  if (!std::isfinite(focal_length) || focal_length == 0) {
    throw Error("thin_lens: focal length = " + to_text(focal_length) + " mm; must be finite and not 0");
  }
  if (!(f_number > 0)) throw Error("thin_lens: f-number = " + to_text(f_number) + "; must be above 0");
  if (!std::isfinite(z)) throw Error("thin_lens: z = " + to_text(z) + " mm; must be finite");
  const Pupil pupil{z, std::abs(focal_length) / f_number};
  return {z - focal_length, z + focal_length, focal_length, focal_length, {pupil, pupil}, z, z};
}

IdealLens thin_lens(const IdealLens& lens) {
  const double z = lens.rear_principal_z();
  IdealLens thin = lens;
  thin.front_focal_z = z - lens.front_focal_length;
  thin.pupils.entrance = thin.pupils.exit = {z, lens.pupils.entrance.diameter};
  return thin;
}

Prescription thin_elements(double focal_length, double f_number) {
  if (!(focal_length > 0 && std::isfinite(focal_length) && f_number > 0 && std::isfinite(f_number))) {
    throw Error("thin elements: focal_length, f_number = " + to_text(focal_length) + ", " + to_text(f_number) +
                "; must be positive and finite");
  }
  constexpr double index = 1.5168;  // N-BK7 at the d line
  const double radius = 4 * (index - 1) * focal_length;
  Prescription p;
  p.id = "thin", p.name = "thin lens of " + to_text(focal_length) + " mm";
  const SurfaceRow front{.radius = radius,
                         .medium = {.glass = "N-BK7", .nd = index},
                         .semi_diameter = std::min(focal_length / f_number / 2, 0.9 * radius)};
  const SurfaceRow rear{.radius = -radius};
  p.surfaces = {front, rear, front, rear};
  p.surfaces.front().stop = true;
  p.surfaces.back().thickness = focal_length;
  return p;
}

IdealLens thin_lens(const Lens& lens, Wavelength wavelength) { return thin_lens(thick_lens(lens, wavelength)); }

IdealLens thick_lens(const Lens& lens, Wavelength wavelength) {
  const Meridian meridian = main_meridian(lens, wavelength);
  const FirstOrder data = first_order(lens, wavelength, meridian);
  if (data.afocal) throw Error(lens.name() + ": ideal lens: the lens has no focal length; must not be afocal");
  if (data.image_index < 0) {
    throw Error(lens.name() + ": ideal lens: light leaves the lens towards -z; must leave towards +z");
  }
  IdealLens result = paraxial_detail::focal_points(lens, data);
  result.pupils = pupils(lens, wavelength, meridian);
  return result;
}

double film_height_for_angle(const Lens& lens, double vertical_angle_rad) {
  if (!(vertical_angle_rad > 0 && vertical_angle_rad < std::numbers::pi)) {
    throw Error("vertical_angle_rad = " + to_text(vertical_angle_rad) + "; must be more than 0 and less than pi");
  }
  const IdealLens ideal = thick_lens(lens);
  const ScenePoint seen = ideal.scene_of({0, -1, lens.film_z()});
  const double depth = seen.at_infinity ? seen.position.z : ideal.pupils.entrance.z - seen.position.z;
  return 2 * std::tan(vertical_angle_rad / 2) / std::abs(seen.position.y / depth);
}

double signed_blur(const ImagePoint& image, const Film& film) {
  const Vec3<double> n = film.normal(), to_film = Vec3<double>(0, 0, film.z()) - image.position;
  return image.diameter_per_mm * glm::dot(n, to_film) / (n.z + n.x * image.slope_x + n.y * image.slope_y);
}

std::optional<FilmPoint> chief_point(const ImagePoint& image, const Film& film) {
  const Ray<double> chief{image.position, {image.slope_x, image.slope_y, 1}};
  const Vec3<double> hit = core_detail::meet_plane(chief, {0, 0, film.z()}, film.normal());
  if (!std::isfinite(hit.x + hit.y + hit.z)) return {};
  return film.point(hit);
}

MarginalRay marginal_ray(const IdealLens& lens, double p) noexcept {
  // The height of a ray in the rear focal plane depends only on its slope in front of the lens, and its slope behind
  // the lens only on its height in the front focal plane.
  if (const Pupil& in = lens.pupils.entrance; std::isfinite(in.z)) {
    const double slope = in.diameter / 2 / (p + (in.z - lens.front_focal_z));
    const double height = std::isinf(p) ? in.diameter / 2 : slope * p;
    return {slope * lens.front_focal_length, -height / lens.rear_focal_length};
  }
  const double height = lens.pupils.exit.diameter / 2;
  return {height, -height * (p / lens.product())};
}

}  // namespace petzval
