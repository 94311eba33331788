// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/aim.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {

/// The plane whose points (x, y) parametrise the rays of a scene or film point.
///
/// For a scene point at a field below 89 degrees it is the plane of the paraxial entrance pupil, with x and y of the
/// lens frame. At larger fields it is perpendicular to the line from the centre of the pupil to the point, with y
/// rotated by the field angle, because rays would meet the pupil edge-on. For a film point it is the plane of the last
/// vertex. Rays of a scene point travel to the film, rays of a film point to the scene.
class PETZVAL_API PupilPlane {
 public:
  /// The plane for a scene point.
  ///
  /// @throws Error  if scene_point() does
  PupilPlane(const Lens& lens, const FieldPoint& point);

  /// The plane for a film point.
  ///
  /// @throws Error  if the point is not finite or the film lies in the plane of the last vertex
  static PupilPlane of_film(const Lens& lens, const FilmPoint& point);

  /// The plane through a given centre that faces a point.
  ///
  /// @param centre               centre of the plane (lens frame, mm)
  /// @param field_rad            angle of the point from the axis (rad)
  /// @param azimuth              azimuth of the point, a unit vector perpendicular to the axis
  /// @param reciprocal_distance  1 / distance of the point from the centre (1/mm); 0: infinity
  static PupilPlane facing(const Vec3<double>& centre, double field_rad, const Vec2<double>& azimuth,
                           double reciprocal_distance) noexcept;

  /// Direction of travel of the rays.
  Travel travel() const noexcept { return travel_; }
  /// True if the point lies on the axis.
  bool on_axis() const noexcept { return towards_.x == 0 && towards_.y == 0; }
  /// True if the plane is rotated to face the point.
  bool turned() const noexcept { return turned_; }

  /// Centre (mm) and unit normal of the plane. The point lies at centre() + towards() / reciprocal_distance(), with the
  /// unit vector towards(); the reciprocal distance is 0 at infinity and negative if the pupil lies in front of the
  /// point.
  const Vec3<double>& centre() const noexcept { return centre_; }
  const Vec3<double>& normal() const noexcept { return normal_; }
  const Vec3<double>& towards() const noexcept { return towards_; }
  double reciprocal_distance() const noexcept { return reciprocal_distance_; }

  /// The point (x, y) of the plane in the lens frame (mm).
  Vec3<double> at(double x, double y) const noexcept { return centre_ + x_axis_ * x + y_axis_ * y; }
  /// The ray of the point through (x, y). It starts in the plane: its precision does not depend on the distance of the
  /// point.
  Ray<double> ray(double x, double y) const noexcept;
  /// N rays, with N the smaller size of x and y. Outputs must not alias inputs.
  void rays(std::span<const double> x, std::span<const double> y, const RayArrays<double>& rays) const noexcept;

  /// Intersection of the line of a ray with the plane (mm).
  Vec2<double> meet(const Ray<double>& ray) const noexcept;

  /// Unit direction of the point's ray through a position (lens frame, mm).
  Vec3<double> direction_at(const Vec3<double>& position) const noexcept;

 private:
  PupilPlane() = default;

  Travel travel_ = Travel::to_film;
  bool turned_ = false;
  Vec3<double> centre_{0, 0, 0}, x_axis_{1, 0, 0}, y_axis_{0, 1, 0}, normal_{0, 0, 1};
  Vec3<double> towards_{0, 0, -1};
  double reciprocal_distance_ = 0;
};

}  // namespace petzval
