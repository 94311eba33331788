// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/core/ray.hpp"
#include "petzval/core/vec.hpp"
#include "petzval/film/film.hpp"
#include "petzval/pupil/field_point.hpp"

namespace petzval::inline v0 {

/// What a camera makes of a ray from the scene, for light tracing and bidirectional methods.
///
/// The film's mean irradiance is the integral of We x radiance over the rays of the scene, in the measure cos dA dw of
/// any surface in front of the lens. With a film normalised for irradiance We is transmittance / film area for every
/// ray that arrives (there is no cosine in it; the square of the index in front of the lens, where that is not 1);
/// unity on the axis divides it as it divides the weights. A film in another medium changes the weights of film samples
/// by the square of its index, and not We: derivation in lib/camera/importance.cpp.
struct Importance {
  double we = 0;  ///< 1/mm^2; 0 for a ray that is lost or misses the film
  RayFate fate = RayFate::vignetted;
  FilmPoint film{};  ///< where the ray meets the plane of the film
  std::array<double, 2> raster{0, 0};
  double pdf_film = 0;   ///< 1/mm^2
  double pdf_pupil = 0;  ///< of the film-side sample that would be this ray, 1/mm^2
  /// Density of this ray among film-side samples in the measure of the scene, cos dA dw, as a product: of its place on
  /// the entrance pupil (1 / the pupil's paraxial area, 1/mm^2, in a plane across the ray) and of its direction there
  /// (1/sr). We divided by the product is the weight of the film sample that is this ray. Times the cosine at a scene
  /// point it is what a pdf of sample_importance is to be compared with for points spread by area.
  double pdf_position = 0, pdf_direction = 0;

  explicit operator bool() const noexcept { return we > 0; }
};

/// A connection from a scene point to the camera.
struct ImportanceSample {
  Vec3<double> direction{0, 0, 1};  ///< unit, from the point to the lens
  double distance = 0;              ///< from the point to `on_pupil`, mm
  Vec3<double> on_pupil{0, 0, 0};  ///< where the line passes the pupil, mostly within the lens: a shadow ray ends there
  double pdf = 0;                  ///< of the direction at the point, 1/sr; 0 where there is nothing to connect to
  Importance importance{};

  explicit operator bool() const noexcept { return importance.we > 0; }
};

/// How the search for a film point ended.
enum class ProjectionStatus : std::uint8_t {
  converged,     ///< the point's chief ray meets the film
  outside_film,  ///< it meets the film plane beside the film
  vignetted,     ///< it ends in the lens: the point may be seen by other rays
  not_visible,   ///< no chief ray from this point, or one that meets the plane of the film far beside it
};
/// "converged", "outside_film", "vignetted" or "not_visible".
PETZVAL_API std::string_view name(ProjectionStatus status) noexcept;

/// film and raster are filled in for all but not_visible; where the model loses the chief ray, or the point's image
/// lies beside the film, they may be off by as much as a table of exact chief rays is.
struct Projection {
  ProjectionStatus status = ProjectionStatus::not_visible;
  FilmPoint film{};
  std::array<double, 2> raster{0, 0};

  explicit operator bool() const noexcept { return status == ProjectionStatus::converged; }
};

}  // namespace petzval::inline v0
