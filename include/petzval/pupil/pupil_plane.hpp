// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/field_point.hpp"
#include "petzval/trace/batch.hpp"

namespace petzval::inline v0 {

/// The plane in which the rays of a point are told apart, those of a scene point in front of the lens, those of a film
/// point (which run against the light) behind it.
///
/// For a scene point it is the plane of the paraxial entrance pupil, x and y those of the lens frame, for fields below
/// 89 degrees; from there on, where that plane is seen edge-on, it is perpendicular to the line from the pupil's centre
/// to the point, its y axis the pupil's turned by the field. For a film point it is the plane of the last vertex.
class PETZVAL_API PupilPlane {
 public:
  /// Throws Error for a field beyond 180 degrees or not finite, an entrance pupil at infinity (object-space
  /// telecentric: a field angle has no meaning there), and a point that is not in front of the lens: in the pupil's
  /// plane, in or behind the first surface, or at a plane that the field's line does not meet.
  PupilPlane(const Lens& lens, const FieldPoint& point);

  /// Throws Error for a point that is not finite and a film in the plane of the last vertex.
  static PupilPlane of_film(const Lens& lens, const FilmPoint& point);

  /// Which way the rays go through the lens.
  Travel travel() const noexcept { return travel_; }
  /// The point lies on the axis.
  bool on_axis() const noexcept { return towards_.x == 0 && towards_.y == 0; }
  /// Turned to face the point.
  bool turned() const noexcept { return turned_; }

  /// The plane's centre and unit normal. The point lies at centre() + towards() / reciprocal_distance(): towards() has
  /// unit length, and the reciprocal is 0 at infinity and negative where the pupil lies in front of the point.
  const Vec3<double>& centre() const noexcept { return centre_; }
  const Vec3<double>& normal() const noexcept { return normal_; }
  const Vec3<double>& towards() const noexcept { return towards_; }
  double reciprocal_distance() const noexcept { return reciprocal_distance_; }

  /// The ray of the point through (x, y), started in the plane and never at the point: nothing is lost however far that
  /// is.
  Ray<double> ray(double x, double y) const noexcept;
  /// The same for many. x, y, and rays: N each, apart in memory.
  void rays(std::span<const double> x, std::span<const double> y, const RayArrays<double>& rays) const noexcept;

  /// Where the line of a ray meets the plane.
  std::array<double, 2> meet(const Ray<double>& ray) const noexcept;

  /// The unit direction in which the ray of the point that passes a place (lens frame, mm) runs towards the lens.
  Vec3<double> direction_at(const Vec3<double>& place) const noexcept;

 private:
  PupilPlane() = default;

  Travel travel_ = Travel::to_film;
  bool turned_ = false;
  Vec3<double> centre_{0, 0, 0}, x_axis_{1, 0, 0}, y_axis_{0, 1, 0}, normal_{0, 0, 1};
  Vec3<double> towards_{0, 0, -1};
  double reciprocal_distance_ = 0;
};

}  // namespace petzval::inline v0
