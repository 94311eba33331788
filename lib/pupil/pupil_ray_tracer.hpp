// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil/pupil_plane.hpp"

namespace petzval::pupil_detail {

/// A point of the pupil plane and the approximate distances to its neighbours in the search.
struct PassingPoint {
  Vec2<double> at{0, 0}, spacing{0, 0};
};

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

/// Meaning of x and y: positions in the plane (mm), or the angles (rad, AngleMap) of these positions, seen from a
/// point at a finite distance.
enum class Coordinates { plane, angles };

/// Traces rays of one point in batches and keeps the buffers.
class PupilRayTracer {
 public:
  PupilRayTracer(const Lens& lens, const PupilPlane& plane, std::size_t wavelength, Coordinates coordinates);

  const Lens& lens() const noexcept { return lens_; }
  const PupilPlane& plane() const noexcept { return plane_; }
  Coordinates coordinates() const noexcept { return coordinates_; }

  /// Clearances of the rays through (x[i], y[i]), as in trace/clearances.hpp, reproducible.
  /// @param apertures as in BatchOptions
  /// @return N values, valid until the next call
  std::span<const double> clearances(std::span<const double> x, std::span<const double> y, bool apertures = true);

  /// Fates and surfaces at the ends of N rays, valid until the next call.
  struct Ends {
    std::span<const RayFate> fates;
    std::span<const int> surfaces;
  };
  Ends ends(std::span<const double> x, std::span<const double> y);

  /// Largest absolute coordinate, seen from the point, of the surface through which rays enter.
  double reach() const;

  /// Position of the chief ray, ignoring apertures; nullopt if no ray goes through the centre of the stop.
  std::optional<Vec2<double>> chief() const;

  /// Finds positions whose rays pass, within the visible part of the surface through which rays enter: on a grid of 48
  /// x 48 steps and, if few rays pass, near maxima of the clearance on a grid of 96 x 96. If there are several
  /// components, it returns the component nearest to the chief ray, or the largest component if there is no chief ray.
  std::vector<PassingPoint> passing_points();

 private:
  RayArrays<double> rays(std::span<const double> x, std::span<const double> y);

  const Lens& lens_;
  PupilPlane plane_;
  AngleMap angle_map_;
  Coordinates coordinates_;
  std::size_t wavelength_;
  std::array<std::vector<double>, 2> positions_;
  std::array<std::vector<double>, 6> rays_;
  std::vector<double> values_;
  std::vector<RayFate> fates_;
  std::vector<int> surfaces_;
};

}  // namespace petzval::pupil_detail
