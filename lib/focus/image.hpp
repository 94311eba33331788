// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/export.hpp"
#include "petzval/pupil/ray_bundle.hpp"

/// How the blur of rays depends on where an upright film stands.
namespace petzval::focus_detail {

/// The image of one subject by a criterion: the film where it is sharpest, and the blur's diameter on any other.
struct PETZVAL_API Image {
  double film_z = 0;  ///< infinite where the rays leave parallel
  /// min_rms: the diameter is a hyperbola over the film's position. Its least value, and its slope far off.
  double least = 0, slope = 0;
  /// The other criteria: the diameter is twice the largest radius of these rays, which are relative to the centroids of
  /// their fields.
  RayBundle rays{};

  double diameter(double film_z) const noexcept;
};

/// Scales the weights of a bundle with slopes to a sum of 1 (equal ones where it has none) and makes its points and
/// slopes relative to their centroid, or leaves them where that is known to be the axis. False where no ray has weight.
PETZVAL_API bool centre(RayBundle& bundle, bool centroid_on_axis = false);

/// By the RMS radius, of a bundle that is centred, or several whose weights sum to 1. Infinite film_z for parallel
/// rays.
PETZVAL_API Image least_rms(const RayBundle& rays);
/// By the largest radius; weights do not count.
PETZVAL_API Image least_maximum(RayBundle rays);

}  // namespace petzval::focus_detail
