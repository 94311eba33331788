// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "petzval/camera/ray_model.hpp"
#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/field_point.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "petzval/pupil_table/ray_derivatives.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"

namespace petzval::inline v0 {

namespace camera_detail {
/// What loops know of a tilted film, by numbers of the film's own axes.
struct TiltedPlane {
  double x_by_x = 1, x_by_y = 0, y_by_y = 1;    ///< place across the axis; y does not change with x
  double depth_by_x = 0, depth_by_y = 0;        ///< distance from the pupil's plane, in that of the upright film
  double slope_x = 0, slope_y = 0, cosine = 1;  ///< as in FilmTilt; between the film's normal and the axis

  double slope_along(const FilmPoint& p) const noexcept { return slope_x * p.x + slope_y * p.y; }
};
}  // namespace camera_detail

/// How far from the axis the lines of a film's points meet the plane of the upright film: what a model has to be built
/// for, mm. Of an upright film its own radius. Throws Error for a film that is no rectangle or tilted by a quarter turn
/// or more, and for a tilted one that comes near to the plane of the pupil or to the pupil of a model of first order:
/// of a thin lens, its rear principal plane.
PETZVAL_API double upright_radius(const Lens& lens, const Film& film, ModelKind model);

/// A tilted film before a model.
///
/// What a model knows are lines, told by their points in the planes of the upright film and of the pupil; whether one
/// passes does not depend on the film. A tilted film takes other samples of them. Its own pupils are a table beside the
/// model's, and contain what of the model's lines meets the film: one pupil for each distance of a key from the axis,
/// whatever lines the points there take. So it is larger than those of its points where light is limited far from the
/// plane of the pupil: behind a telecentric lens of f/50 a film of 20 x 20 mm that leans by 18 degrees sends half of
/// its corners' samples to the scene, by 8 degrees two thirds.
///
/// Immutable, cheap to copy, free to share between threads.
class PETZVAL_API TiltedFilm {
 public:
  /// pupils: of the model, for a film of upright_radius(). Throws Error for a film that is no rectangle, tilted by a
  /// quarter turn or more, or near to the plane of the pupil, and for pupils of a smaller one.
  TiltedFilm(const Film& film, const FilmPupilTable& pupils);

  const Film& film() const noexcept { return film_; }
  /// The film's own pupils, by keys.
  const FilmPupilTable& pupils() const noexcept { return pupils_; }

  /// Where the line from a film point to the middle of the pupil's plane meets the plane of the upright film.
  FilmPoint key(const FilmPoint& film) const noexcept;
  /// The upright film's line that is the one of a key's film point through a place in the plane of the pupil.
  TwoPlaneRay upright(const FilmPoint& key, double pupil_x, double pupil_y) const noexcept;
  /// The key of the film point that a line meets; nothing for a line that meets the back of the film, or runs along it.
  std::optional<FilmPoint> key_of(const TwoPlaneRay& line) const noexcept;
  /// The film point of a key.
  FilmPoint point(const FilmPoint& key) const noexcept;
  /// By how much the weight of a film sample differs from that of its upright line; 0: it meets the film's back.
  double weight(const FilmPoint& key, double pupil_x, double pupil_y) const noexcept;
  /// The upright line of a film sample, with its derivatives by film x and y.
  TwoPlaneRayDerivatives line(const FilmPoint& film, double u, double v, std::size_t wavelength) const noexcept;

  const camera_detail::TiltedPlane& plane() const noexcept { return plane_; }

 private:
  Film film_;
  camera_detail::TiltedPlane plane_;
  FilmPupilTable pupils_;
};

}  // namespace petzval::inline v0
