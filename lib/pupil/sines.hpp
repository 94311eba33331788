// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <glm/geometric.hpp>

#include "petzval/pupil/pupil_plane.hpp"

namespace petzval::inline v0::pupil_detail {

/// Places of a plane by the sines under which its point sees them, times its distance: a surface close to the point
/// has a bounded image, and an area there is a projected solid angle. Of a point at infinity they are the places
/// themselves.
class Sines {
 public:
  explicit Sines(const PupilPlane& plane) noexcept {
    const double cosine = glm::dot(plane.towards(), plane.normal());
    per_distance_ = std::abs(plane.reciprocal_distance() / cosine);
    if (per_distance_ == 0) return;
    const Vec3<double> place = plane.towards() / plane.reciprocal_distance();
    foot_ = plane.meet({plane.centre() + place, plane.normal()});
  }

  Vec2<double> of(const Vec2<double>& p) const noexcept {
    const Vec2<double> d = p - foot_;
    const Vec2<double> s = d * per_distance_;
    return d / std::sqrt(1 + s.x * s.x + s.y * s.y);
  }
  /// Not finite for directions along the plane and beyond.
  Vec2<double> place(const Vec2<double>& sines) const noexcept {
    const Vec2<double> s = sines * per_distance_;
    return foot_ + sines / std::sqrt(1 - s.x * s.x - s.y * s.y);
  }
  /// By how much a step of sines is longer at a place, at most.
  double stretch(const Vec2<double>& p) const noexcept {
    const Vec2<double> s = (p - foot_) * per_distance_;
    const double square = 1 + s.x * s.x + s.y * s.y;
    return square * std::sqrt(square);
  }
  /// One over the distance of the point from the plane, 1/mm; 0 at infinity.
  double per_distance() const noexcept { return per_distance_; }

 private:
  Vec2<double> foot_{0, 0};
  double per_distance_ = 0;
};

}  // namespace petzval::inline v0::pupil_detail
