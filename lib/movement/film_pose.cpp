// SPDX-License-Identifier: Apache-2.0
#include "petzval/movement/film_pose.hpp"

#include <cmath>
#include <glm/geometric.hpp>

#include "petzval/core/error.hpp"
#include "petzval/core/text.hpp"

namespace petzval::inline v0 {

Vec3<double> FilmPose::right() const noexcept { return {std::cos(swing_rad), 0, -std::sin(swing_rad)}; }

Vec3<double> FilmPose::up() const noexcept {
  const double lean = std::sin(tilt_rad);
  return {std::sin(swing_rad) * lean, std::cos(tilt_rad), std::cos(swing_rad) * lean};
}

Vec3<double> FilmPose::normal() const noexcept {
  const double level = std::cos(tilt_rad);
  return {std::sin(swing_rad) * level, -std::sin(tilt_rad), std::cos(swing_rad) * level};
}

double FilmPose::angle() const noexcept {
  const Vec3<double> n = normal();
  return std::atan2(std::hypot(n.x, n.y), n.z);
}

Plane FilmPose::plane() const noexcept {
  const Vec3<double> n = normal();
  return {n, n.z * film_z};
}

Vec3<double> FilmPose::at(const FilmPoint& point) const noexcept {
  return Vec3<double>(0, 0, film_z) + point.x * right() + point.y * up();
}

FilmPoint FilmPose::point(const Vec3<double>& place) const noexcept {
  const Vec3<double> from_axis = place - Vec3<double>(0, 0, film_z);
  return {glm::dot(from_axis, right()), glm::dot(from_axis, up())};
}

FilmPose film_pose(const Plane& plane) {
  const double film_z = plane.offset / plane.normal.z;
  const Vec3<double> n = plane.normal.z < 0 ? -plane.normal : plane.normal;
  if (!std::isfinite(film_z) || !std::isfinite(n.x) || !std::isfinite(n.y)) {
    throw Error("film_pose: the plane has the normal (" + number(plane.normal.x) + ", " + number(plane.normal.y) +
                ", " + number(plane.normal.z) + ") and the offset " + number(plane.offset) +
                " mm, wanted finite ones and a plane that crosses the axis");
  }
  return {film_z, std::atan2(0 - n.y, std::hypot(n.x, n.z)), std::atan2(n.x + 0, n.z)};  // no -0
}

}  // namespace petzval::inline v0
