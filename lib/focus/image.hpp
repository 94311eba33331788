// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/config.hpp"
#include "pupil/ray_bundle.hpp"

/// The blur of rays as a function of the position of an upright film.
namespace petzval::focus_detail {

/// The image of one subject by a focus criterion: the position of the sharpest film, and the blur diameter on any film.
struct PETZVAL_API Image {
  double film_z = 0;  ///< infinite if the rays behind the lens are parallel
  /// min_rms: the diameter is a hyperbola over the film position, with this minimum and this asymptotic slope.
  double least = 0, slope = 0;
  /// Other criteria: the diameter is twice the largest radius of these rays, relative to the centroids of their fields.
  RayBundle rays{};

  double diameter(double film_z) const noexcept;
};

/// Scales the weights of a bundle with slopes to the sum 1 (equal weights if the bundle has none), and makes points and
/// slopes relative to their centroid.
/// @param centroid_on_axis leaves points and slopes unchanged, because the centroid lies on the axis
/// @return false if no ray has a weight
PETZVAL_API bool centre(RayBundle& bundle, bool centroid_on_axis = false);

/// The image with the least RMS radius.
/// @param rays a centred bundle, or several bundles whose weights sum to 1
/// @return film_z is infinite if the rays are parallel
PETZVAL_API Image least_rms(const RayBundle& rays);
/// The image with the least maximum radius; ignores weights.
PETZVAL_API Image least_maximum(RayBundle rays);

}  // namespace petzval::focus_detail
