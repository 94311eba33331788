// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "lens_facts.hpp"
#include "petzval/camera/model_kind.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/pupil_table/film_pupil_table.hpp"
#include "petzval/pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

/// A film at a moment, in its own coordinates: its points, their virtual points, and the rays that meet it.
struct PETZVAL_API TiltedPlane {
  double x_by_x = 1, x_by_y = 0, y_by_y = 1;    ///< position across the axis; y does not change with x
  double depth_by_x = 0, depth_by_y = 0;        ///< distance from the pupil's plane over that of the upright film
  double slope_x = 0, slope_y = 0, cosine = 1;  ///< as in FilmTilt; between the film's normal and the axis
  double travel = 0;                            ///< along the axis, over the upright film's distance from the pupil

  FilmPoint virtual_point(const FilmPoint& film) const noexcept;
  /// The film point of a virtual point.
  FilmPoint point(const FilmPoint& virtual_point) const noexcept;
  /// By how much the upright film's distance from the pupil's plane is larger than that of the film point, in parts of
  /// the latter.
  double nearer_by(const FilmPoint& virtual_point) const noexcept;
  /// The same of a film point, with its derivatives by film x and y.
  struct Nearer {
    double value = 0;
    Vec2<double> by{0, 0};
  };
  Nearer nearer_at(const FilmPoint& film) const noexcept;
  /// The image-space ray that runs from the film point of a virtual point through a place in the pupil's plane.
  TwoPlaneRay upright(const FilmPoint& virtual_point, const FilmPoint& place) const noexcept;
  /// The virtual point of the film point that a ray meets. Nothing for a ray that meets the back of the film or is
  /// parallel to it.
  std::optional<FilmPoint> virtual_point_of(const TwoPlaneRay& ray) const noexcept;
  /// The weight of a film sample over that of the upright film's sample with the same ray; 0: it meets the film's back.
  double weight(const FilmPoint& virtual_point, const FilmPoint& place) const noexcept;
};

/// petzval::upright_radius(), for a film whose place is the lens's.
double upright_radius(const LensFacts& facts, const Film& film, ModelKind model);

/// A film that is tilted, or moves along the axis while the shutter is open, in front of a model.
///
/// A model maps image-space rays, which are given by their points on the planes of the upright film and of the pupil;
/// whether a ray passes does not depend on the film. A tilted film samples other rays. Each of its points is identified
/// by its virtual point: its projection, through the centre of the pupil's plane, onto the upright film. The pupils of
/// the tilted film are a second table, over virtual points: one pupil for each distance from the axis, or with
/// cylinders for each point and its mirror images, which contains the model's rays to all points there, at all times.
/// It is larger than theirs where light is limited far from the plane of the pupil: behind a telecentric lens of f/50,
/// half of the corners' samples of a film of 20 x 20 mm tilted by 18 degrees reach the scene, and two thirds for 8
/// degrees.
///
/// Immutable, cheap to copy, shared freely between threads.
class PETZVAL_API TiltedFilm {
 public:
  /// pupils: those of the model, for a film of upright_radius(). Throws Error for a film that is no rectangle, tilted
  /// by a quarter turn or more, or near to the plane of the pupil at any time, and for pupils of a smaller film.
  TiltedFilm(const Film& film, const FilmPupilTable& pupils, int threads = 1);

  /// With its place.
  const Film& film() const noexcept { return film_; }
  /// The film's own pupils, over virtual points.
  const FilmPupilTable& pupils() const noexcept { return pupils_; }

  /// Where the film is at a part of the time that the shutter is open (0 to 1, clamped).
  TiltedPlane plane(double time) const noexcept;
  /// The image-space ray of a film sample, with its derivatives by film x and y. area: of the sample.
  TwoPlaneRayDerivatives line(const FilmPoint& film, double u, double v, Wavelength wavelength, double time,
                              double& area) const noexcept;

 private:
  Film film_;
  TiltedPlane first_;  // when the shutter opens
  double travel_ = 0;  // until it closes, as TiltedPlane::travel
  FilmPupilTable pupils_;
};

}  // namespace petzval::camera_detail
