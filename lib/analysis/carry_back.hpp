// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "petzval/core/film.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/pupil_plane.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"

/// Errors in the scene as lengths on the film.
namespace petzval::analysis_detail {

/// One plane of the scene as a film point sees it, measured on the film.
///
/// Hits on a plane z are carried back by the exact magnification of the chief ray, the inverse of the derivative of its
/// hit by the film point: lengths along and across the radius have different ones. From 80 degrees on, where planes z
/// are seen edge-on, a plane across the chief ray replaces them, as far along the ray as the plane z lies at 80
/// degrees. At infinity, and for rays that do not run towards the plane, it is the angle times the focal length.
class SceneView {
 public:
  /// Measures angles only.
  explicit SceneView(double focal_length, const Vec3<double>& chief = {0, 0, -1});
  /// The plane `z`: chief, by_film_x and by_film_y: the chief ray and its derivatives by the film point.
  SceneView(double focal_length, double z, const Ray<double>& chief, const Ray<double>& by_film_x,
            const Ray<double>& by_film_y);

  /// The hit of a ray, from that of the chief ray, mm on the film.
  Vec2<double> place(const Ray<double>& ray) const noexcept;
  /// The distance between two rays of the film point, mm on the film.
  double distance(const Ray<double>& a, const Ray<double>& b) const noexcept;

 private:
  Vec2<double> hit(const Ray<double>& ray) const noexcept;
  bool meets(const Ray<double>& ray) const noexcept;

  bool plane_ = false;
  double focal_length_;
  Vec3<double> centre_{0, 0, 0}, normal_, x_axis_, y_axis_;
  std::array<double, 4> to_film_{1, 0, 0, 1};  // rows: film x and y by x and y in the plane
};

/// The chief ray of a film point: the ray through the middle of the pupil, not clipped by apertures. As the film point
/// moves, the ray turns about its point in the plane of the paraxial exit pupil.
struct ChiefRay {
  Vec2<double> pupil{0, 0};
  bool found = false;  ///< else angles are measured for all planes
  double focal_length = 0;
  Ray<double> ray{}, by_film_x{}, by_film_y{};

  /// The plane z; -inf: infinity.
  SceneView view(double z) const;
};

/// Finds chief rays.
class ChiefRays {
 public:
  /// Throws Error for a lens without focal length, which measures angles.
  ChiefRays(const Lens& lens, const TwoPlanes& space);
  ChiefRay through(const FilmPoint& film, const Vec2<double>& pupil, std::size_t wavelength) const;

 private:
  Lens lens_;
  TwoPlanes space_;
  double focal_length_ = 0, pivot_ = 0;  // from the film to the exit pupil; infinite where the lens is telecentric
  double sense_ = 1;                     // of z in which light runs behind the lens
};

}  // namespace petzval::analysis_detail
