// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/core/version.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/trace/trace.hpp"

namespace petzval {

/// A point of the scene, seen from the centre of the paraxial entrance pupil: `field_rad` away from the axis, in the
/// direction `azimuth_rad` turned from +y to +x. A field of +10 degrees lies towards +y, and a lens that turns its
/// image upside down images it at negative y.
///
/// The pupil is that of the primary wavelength in the meridian y, so that a point is the same for every wavelength.
/// Points at 90 degrees and more lie beside the lens: at a finite distance their plane is behind the pupil.
struct FieldPoint {
  double field_rad = 0;    ///< within 180 degrees
  double z = 0;            ///< lens frame, mm; the plane the point lies in; -inf at infinity
  double azimuth_rad = 0;  ///< 0: towards +y; a quarter turn: towards +x
};

/// The plane that parametrises the rays of a point: (x, y) is where a ray crosses it. Rays of a scene point enter the
/// lens from the front, those of a film point run backwards, from behind.
///
/// For a scene point at a field below 89 degrees it is the plane of the paraxial entrance pupil, x and y those of the
/// lens frame. At larger fields, which see that plane edge-on, it is perpendicular to the line from the pupil's centre
/// to the point, its y axis turned by the field. For a film point it is the plane of the last vertex.
class PETZVAL_API PupilPlane {
 public:
  /// Throws Error for a field beyond 180 degrees or not finite, an entrance pupil at infinity (object-space
  /// telecentric: a field angle has no meaning there), and a point that is not in front of the lens: in the plane of
  /// the pupil, in or behind the first surface, or at a plane that the line of the field does not meet.
  PupilPlane(const Lens& lens, const FieldPoint& point);

  /// Throws Error for a point that is not finite and a film in the plane of the last vertex.
  static PupilPlane of_film(const Lens& lens, const FilmPoint& point);

  /// The plane through any centre that faces a point in front of it: in a field (rad) and the azimuth of a unit vector
  /// across the axis, at a reciprocal distance from the centre (1/mm; 0: at infinity).
  static PupilPlane facing(const Vec3<double>& centre, double field_rad, const Vec2<double>& azimuth,
                           double reciprocal_distance) noexcept;

  /// Direction of travel of the rays.
  Travel travel() const noexcept { return travel_; }
  /// The point lies on the axis.
  bool on_axis() const noexcept { return towards_.x == 0 && towards_.y == 0; }
  /// Turned to face the point.
  bool turned() const noexcept { return turned_; }

  /// Centre and unit normal of the plane. The point lies at centre() + towards() / reciprocal_distance(): towards() has
  /// unit length, and the reciprocal is 0 at infinity and negative where the pupil lies in front of the point.
  const Vec3<double>& centre() const noexcept { return centre_; }
  const Vec3<double>& normal() const noexcept { return normal_; }
  const Vec3<double>& towards() const noexcept { return towards_; }
  double reciprocal_distance() const noexcept { return reciprocal_distance_; }

  /// The place (x, y) in the lens frame, mm.
  Vec3<double> at(double x, double y) const noexcept { return centre_ + x_axis_ * x + y_axis_ * y; }
  /// The ray of the point through (x, y). It starts in the plane, so that precision does not depend on the distance of
  /// the point.
  Ray<double> ray(double x, double y) const noexcept;
  /// The same for many. x, y, and rays: N each; points without both coordinates are left out. Outputs must not
  /// alias inputs.
  void rays(std::span<const double> x, std::span<const double> y, const RayArrays<double>& rays) const noexcept;

  /// Where a ray, prolonged both ways, meets the plane.
  Vec2<double> meet(const Ray<double>& ray) const noexcept;

  /// Unit direction of the ray of the point through a place (lens frame, mm).
  Vec3<double> direction_at(const Vec3<double>& place) const noexcept;

 private:
  PupilPlane() = default;

  Travel travel_ = Travel::to_film;
  bool turned_ = false;
  Vec3<double> centre_{0, 0, 0}, x_axis_{1, 0, 0}, y_axis_{0, 1, 0}, normal_{0, 0, 1};
  Vec3<double> towards_{0, 0, -1};
  double reciprocal_distance_ = 0;
};

}  // namespace petzval
