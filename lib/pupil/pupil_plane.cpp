// SPDX-License-Identifier: Apache-2.0
#include "pupil/pupil_plane.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <string>

#include "core/meet_plane.hpp"
#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "surface_box.hpp"

namespace petzval {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void check(const Lens& lens, const FieldPoint& point, const Pupil& entrance) {
  const auto refuse = [&](const std::string& value_and_rule) {
    throw Error(lens.name() + ": scene point: " + value_and_rule);
  };
  if (!(std::abs(point.field_rad) <= std::numbers::pi)) {
    refuse("field = " + to_text(degrees(point.field_rad), 6) + " degrees; must be -180 to 180");
  }
  if (!std::isfinite(point.azimuth_rad)) {
    refuse("azimuth = " + to_text(point.azimuth_rad) + " rad; must be finite");
  }
  if (!std::isfinite(entrance.z)) {
    refuse("the entrance pupil is at infinity; must be at a finite distance, as fields are seen from the pupil");
  }
  if (!(point.z < infinity)) refuse("z = " + to_text(point.z) + " mm; must be finite or -inf");
  if (point.z == entrance.z) {
    refuse("z = " + to_text(point.z) + " mm; must differ from z of the entrance pupil");
  }
  if (std::isinf(point.z)) return;

  // Fields below 90 degrees meet planes in front of the lens; larger fields meet planes next to or behind the lens.
  if (std::abs(point.field_rad) < std::numbers::pi / 2) {
    const double front = pupil_detail::surface_box(lens, 0, entrance).z_min;
    if (!(point.z < front)) {
      refuse("z = " + to_text(point.z) +
             " mm; must be in front of the first surface, which begins at z = " + to_text(front) + " mm");
    }
  } else {
    const double side = std::abs(std::tan(point.field_rad) * (entrance.z - point.z));
    if (!(point.z > entrance.z && side > pupil_detail::half_height(lens, 0, entrance))) {
      refuse("z = " + to_text(point.z) + " mm at field = " + to_text(degrees(point.field_rad), 6) +
             " degrees; must be -inf, or a plane behind the entrance pupil (" + to_text(entrance.z) +
             " mm) that this field meets outside the lens");
    }
  }
}

/// Direction of the ray between the point and a position in the plane; `position` is relative to the centre. The form
/// (place - point) / distance contains no large numbers, and at infinity its first term is 0. A negative distance means
/// that the rays reach the point after the plane; it reverses place - point.
Vec3<double> direction_from(const Vec3<double>& position, const Vec3<double>& towards,
                            double reciprocal_distance) noexcept {
  const Vec3<double> d = position * reciprocal_distance - towards;
  return d * (1 / glm::length(d));
}

}  // namespace

ScenePoint scene_point(const Lens& lens, const FieldPoint& point) {
  const PupilPlane plane(lens, point);
  if (plane.reciprocal_distance() == 0) return {plane.towards(), true};
  return {plane.centre() + plane.towards() / plane.reciprocal_distance(), false};
}

PupilPlane::PupilPlane(const Lens& lens, const FieldPoint& point) {
  const Pupil entrance = pupils(lens, lens.primary_wavelength()).entrance;
  check(lens, point, entrance);
  const double cosine = std::cos(point.field_rad);
  *this = facing({0, 0, entrance.z}, point.field_rad, {std::sin(point.azimuth_rad), std::cos(point.azimuth_rad)},
                 std::isinf(point.z) ? 0 : cosine / (entrance.z - point.z));
  if (cosine < std::cos(radians(89.0))) return;
  turned_ = false;
  x_axis_ = {1, 0, 0}, y_axis_ = {0, 1, 0}, normal_ = {0, 0, 1};
}

PupilPlane PupilPlane::facing(const Vec3<double>& centre, double field_rad, const Vec2<double>& azimuth,
                              double reciprocal_distance) noexcept {
  const double sine = std::sin(field_rad), cosine = std::cos(field_rad);
  PupilPlane plane;
  plane.turned_ = true;
  plane.centre_ = centre;
  plane.towards_ = plane.normal_ = {azimuth.x * sine, azimuth.y * sine, -cosine};
  plane.x_axis_ = {azimuth.y, -azimuth.x, 0};
  plane.y_axis_ = {azimuth.x * cosine, azimuth.y * cosine, sine};
  plane.reciprocal_distance_ = reciprocal_distance;
  return plane;
}

PupilPlane PupilPlane::of_film(const Lens& lens, const FilmPoint& point) {
  const std::string where = lens.name() + ": film point: ";
  for (const double coordinate : {point.x, point.y}) {
    if (std::isfinite(coordinate)) continue;
    throw Error(where + "coordinate = " + to_text(coordinate) + " mm; must be finite");
  }
  const double last_z = lens.surfaces().back().vertex_z;
  if (lens.film_z() == last_z) {
    throw Error(where + "film z = " + to_text(last_z) + " mm; must differ from z of the last vertex");
  }
  const Vec3<double> to_point{point.x, point.y, lens.film_z() - last_z};
  // A film in front of the last vertex receives a virtual image: its rays behave as if the film stood behind the lens.
  const double sense = signed_index(lens, lens.surface_count()) > 0 ? 1 : -1;
  const double distance = std::copysign(glm::length(to_point), to_point.z * sense);
  PupilPlane plane;
  plane.travel_ = Travel::to_scene;
  plane.centre_ = {0, 0, last_z};
  plane.towards_ = to_point / distance;
  plane.reciprocal_distance_ = 1 / distance;
  return plane;
}

Vec3<double> PupilPlane::direction_at(const Vec3<double>& position) const noexcept {
  const Vec3<double> d = direction_from(position - centre_, towards_, reciprocal_distance_);
  return glm::dot(d, towards_) > 0 ? -d : d;  // the scene or film point may lie between plane and `position`
}

Ray<double> PupilPlane::ray(double x, double y) const noexcept {
  const Vec3<double> position = x_axis_ * x + y_axis_ * y;
  return {centre_ + position, direction_from(position, towards_, reciprocal_distance_)};
}

void PupilPlane::rays(std::span<const double> x, std::span<const double> y,
                      const RayArrays<double>& rays) const noexcept {
  const std::size_t count = std::min(x.size(), y.size());
  // With __restrict compilers vectorize this loop; they honour it on parameters only.
  const auto fill = [count, plane = *this](const double* __restrict in_x, const double* __restrict in_y,
                                           double* __restrict ox, double* __restrict oy, double* __restrict oz,
                                           double* __restrict dx, double* __restrict dy, double* __restrict dz) {
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3<double> position = plane.x_axis_ * in_x[i] + plane.y_axis_ * in_y[i],
                         origin = plane.centre_ + position;
      const Vec3<double> direction = direction_from(position, plane.towards_, plane.reciprocal_distance_);
      ox[i] = origin.x, oy[i] = origin.y, oz[i] = origin.z;
      dx[i] = direction.x, dy[i] = direction.y, dz[i] = direction.z;
    }
  };
  fill(x.data(), y.data(), rays.x, rays.y, rays.z, rays.dx, rays.dy, rays.dz);
}

Vec2<double> PupilPlane::meet(const Ray<double>& ray) const noexcept {
  const Vec3<double> position = core_detail::meet_plane(ray, centre_, normal_) - centre_;
  return {glm::dot(position, x_axis_), glm::dot(position, y_axis_)};
}

}  // namespace petzval
