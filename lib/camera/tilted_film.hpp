// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "core/dual.hpp"
#include "lens_facts.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "pupil_table/film_pupil_table.hpp"
#include "pupil_table/two_plane_rays.hpp"

namespace petzval::camera_detail {

/// A film at one time, in its own coordinates: film points, their virtual points, and the rays that meet the film.
struct PETZVAL_API TiltedPlane {
  double x_by_x = 1, x_by_y = 0, y_by_y = 1;    ///< position across the axis; y does not depend on film x
  double depth_by_x = 0, depth_by_y = 0;        ///< distance from the pupil plane over distance of the upright film
  double slope_x = 0, slope_y = 0, cosine = 1;  ///< slopes as in FilmTilt; cosine of the angle between normal and axis
  double travel = 0;                            ///< along the axis, relative to the upright film's distance

  FilmPoint virtual_point(const FilmPoint& film) const noexcept;
  FilmPoint point(const FilmPoint& virtual_point) const noexcept;
  /// Distance of the upright film from the pupil plane divided by the distance of the film point, minus 1.
  double distance_excess(const FilmPoint& virtual_point) const noexcept;
  /// distance_excess() of a film point, with its derivatives with respect to film x and y.
  kernel::Dual distance_excess_at(const FilmPoint& film) const noexcept;
  /// Image-space ray from the film point of a virtual point through a position in the pupil plane.
  TwoPlaneRay upright(const FilmPoint& virtual_point, const FilmPoint& position) const noexcept;
  /// Virtual point of the film point that a ray meets; nullopt if the ray meets the back of the film or is parallel to
  /// the film.
  std::optional<FilmPoint> virtual_point_of(const TwoPlaneRay& ray) const noexcept;
  /// Weight of a film sample divided by the weight of the sample of an upright film with the same ray; 0 if the ray
  /// meets the back of the film.
  double weight(const FilmPoint& virtual_point, const FilmPoint& position) const noexcept;
};

/// petzval::upright_radius() for a film at the position of the lens's film.
double upright_radius(const LensFacts& facts, const Film& film, ModelKind model);

/// A film that is tilted, or that travels along the axis while the shutter is open, for any ray model.
///
/// A model maps image-space rays, given by their points in the planes of the upright film and of the pupil; the film
/// does not affect which rays pass. Each point of a tilted film is identified by its virtual point, the projection
/// through the centre of the pupil plane onto the upright film. The pupils of a tilted film are a second table, over
/// virtual points: one pupil for each distance from the axis or, with cylinders, for each point and its mirror images.
/// A pupil contains the model's rays to all film points with this virtual point, at all times.
///
/// Limitations: these pupils exceed the real pupils if light is limited far from the pupil plane, and samples are lost.
/// Behind a telecentric lens of f/50, half of the samples in the corners of a film of 20 x 20 mm reach the scene at a
/// tilt of 18 degrees, two thirds at 8 degrees.
///
/// Immutable, cheap to copy, thread-safe.
class PETZVAL_API TiltedFilm {
 public:
  /// @param pupils pupils of the model, for a film of radius upright_radius()
  /// @throws Error  if the film is no rectangle, is tilted by a quarter turn or more or is close to the pupil plane at
  ///                any time, or if the pupils cover a smaller film
  TiltedFilm(const Film& film, const FilmPupilTable& pupils, int threads = 1);

  /// The film with its position set.
  const Film& film() const noexcept { return film_; }
  /// The pupils of the film, over virtual points.
  const FilmPupilTable& pupils() const noexcept { return pupils_; }

  /// The film at a fraction (0 to 1, clamped) of the time that the shutter is open.
  TiltedPlane plane(double time) const noexcept;

 private:
  Film film_;
  TiltedPlane first_;  // at the time when the shutter opens
  double travel_ = 0;  // at the time when it closes, as TiltedPlane::travel
  FilmPupilTable pupils_;
};

}  // namespace petzval::camera_detail
