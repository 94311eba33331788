// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "petzval/core/film.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "pupil/pupil_plane.hpp"
#include "pupil_table/two_plane_rays.hpp"

/// Ray errors in the scene, expressed as lengths on the film.
namespace petzval::analysis_detail {

/// A scene plane as seen from one film point, in film coordinates.
///
/// Hits on a plane z are mapped to the film by the exact magnification of the chief ray, the inverse of the derivative
/// of its hit with respect to the film point; the magnification differs along and across the radius. Beyond 80 degrees
/// the plane is seen nearly edge-on. It is then replaced by a plane perpendicular to the chief ray, at the distance
/// along the ray that the plane z has at 80 degrees. At infinity, and for rays that do not run towards the plane,
/// lengths are angles times the focal length.
class SceneView {
 public:
  /// Measures angles only.
  explicit SceneView(double focal_length, const Vec3<double>& chief = {0, 0, -1});
  /// The plane `z`.
  /// @param chief, by_film_x, by_film_y the chief ray and its derivatives by the film point
  SceneView(double focal_length, double z, const Ray<double>& chief, const Ray<double>& by_film_x,
            const Ray<double>& by_film_y);

  /// The hit of a ray relative to the hit of the chief ray, mapped to the film, mm.
  Vec2<double> position(const Ray<double>& ray) const noexcept;
  /// Distance on the film between two rays of the film point, mm.
  double distance(const Ray<double>& a, const Ray<double>& b) const noexcept;

 private:
  Vec2<double> hit(const Ray<double>& ray) const noexcept;
  bool meets(const Ray<double>& ray) const noexcept;

  bool plane_ = false;
  double focal_length_;
  Vec3<double> centre_{0, 0, 0}, normal_, x_axis_, y_axis_;
  std::array<double, 4> to_film_{1, 0, 0, 1};  // rows: film x and y; columns: x and y in the plane
};

/// The chief ray of a film point: the ray through the centre of the pupil, not clipped by apertures. If the film point
/// moves, the ray rotates about its point in the plane of the paraxial exit pupil.
struct ChiefRay {
  Vec2<double> pupil{0, 0};
  bool found = false;  ///< false: all planes are measured by angles
  double focal_length = 0;
  Ray<double> ray{}, by_film_x{}, by_film_y{};

  /// The view of the plane z; -inf means infinity.
  SceneView view(double z) const;
};

class ChiefRays {
 public:
  /// Throws Error if the lens has no focal length, because it scales angles to lengths.
  ChiefRays(const Lens& lens, const TwoPlanes& space);
  ChiefRay through(const FilmPoint& film, const Vec2<double>& pupil, std::size_t wavelength) const;

 private:
  Lens lens_;
  TwoPlanes space_;
  double focal_length_ = 0, pivot_ = 0;  // pivot_: distance from the film to the exit pupil; infinite if telecentric
  double sense_ = 1;                     // 1 if light behind the lens runs towards +z, else -1
};

}  // namespace petzval::analysis_detail
