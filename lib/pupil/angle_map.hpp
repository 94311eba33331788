// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "pupil/pupil_plane.hpp"

namespace petzval::pupil_detail {

/// Maps positions in a plane to the sines of their angles, seen from the point, times the distance of the point. The
/// image of a surface close to the point stays bounded. For a point at infinity the map is the identity.
class AngleMap {
 public:
  explicit AngleMap(const PupilPlane& plane) noexcept {
    const double cosine = glm::dot(plane.towards(), plane.normal());
    per_distance_ = std::abs(plane.reciprocal_distance() / cosine);
    if (per_distance_ == 0) return;
    const Vec3<double> position = plane.towards() / plane.reciprocal_distance();
    foot_ = plane.meet({plane.centre() + position, plane.normal()});
  }

  Vec2<double> of(const Vec2<double>& p) const noexcept { return (p - foot_) / std::sqrt(secant2(p)); }
  /// Not finite if the direction is parallel to the plane or points away from it.
  Vec2<double> position(const Vec2<double>& sines) const noexcept {
    const Vec2<double> s = sines * per_distance_;
    return foot_ + sines / std::sqrt(1 - s.x * s.x - s.y * s.y);
  }
  /// Largest factor by which a small step in sines is stretched in the plane.
  double stretch(const Vec2<double>& p) const noexcept {
    const double square = secant2(p);
    return square * std::sqrt(square);
  }
  /// Angles (rad) at which a point at a finite distance sees a position. Angles are bounded too, and they distinguish
  /// directions parallel to the plane.
  Vec2<double> angles(const Vec2<double>& p) const noexcept {
    const Vec2<double> t = tangents(p);
    const double tangent = glm::length(t);
    return tangent == 0 ? t : t * (std::atan(tangent) / tangent);
  }
  /// Not finite if the direction is parallel to the plane or points away from it.
  Vec2<double> position_at_angles(const Vec2<double>& angles) const noexcept {
    const double angle = glm::length(angles);
    if (angle == 0) return foot_;
    const double tangent = angle < std::numbers::pi / 2 ? std::tan(angle) : std::numeric_limits<double>::infinity();
    return foot_ + angles * (tangent / (angle * per_distance_));
  }
  /// Smallest angle per step in the plane, rad/mm.
  double angle_per_step(const Vec2<double>& p) const noexcept { return per_distance_ / secant2(p); }
  /// One over the distance of the point from the plane, 1/mm; 0 at infinity.
  double per_distance() const noexcept { return per_distance_; }

 private:
  Vec2<double> tangents(const Vec2<double>& p) const noexcept { return (p - foot_) * per_distance_; }
  /// Squared secant of the angle at which the point sees a position.
  double secant2(const Vec2<double>& p) const noexcept {
    const Vec2<double> t = tangents(p);
    return 1 + t.x * t.x + t.y * t.y;
  }

  Vec2<double> foot_{0, 0};
  double per_distance_ = 0;
};

}  // namespace petzval::pupil_detail
