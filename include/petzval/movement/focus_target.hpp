// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/movement/ideal_lens.hpp"

namespace petzval::inline v0 {

/// A point of the scene that focus has to serve, at one moment.
struct FocusTarget {
  ScenePoint place;
  double blur_mm = 0;  ///< wanted on the film: 0 sharp; negative: in front of the plane of focus; positive: beyond it
  double weight = 1;   ///< of the squared error of the blur; 0: looked at, not served
};

/// Whether a target's numbers are those of one: no NaN, nothing infinite but z = -inf, no negative weight.
PETZVAL_API bool well_formed(const FocusTarget& target) noexcept;

/// Focal lengths from the rear focal point: farther away no film is, and images are of points in the front focal plane
/// or far beside the lens.
inline constexpr double farthest_film = 1e9;

/// What became of a target.
enum class TargetUse : unsigned char {
  used,
  no_weight,
  not_finite,  ///< a coordinate, the blur or the weight is not a number, or the weight is negative
  no_image,  ///< behind the lens, in it, within the front focal length, or imaged (or as blurred as wanted) too far off
  outlier,   ///< the robust fit gave it no weight
  no_rays,   ///< exact rays: nothing of it gets through the lens
};

/// "used", "no_weight", ...
PETZVAL_API std::string_view name(TargetUse use) noexcept;

/// A target and the blur that it got.
struct TargetBlur {
  TargetUse use = TargetUse::used;
  double wanted_mm = 0;
  double blur_mm = 0;  ///< signed; NaN where it has no image
};

}  // namespace petzval::inline v0
