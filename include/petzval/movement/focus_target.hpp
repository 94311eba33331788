// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval::inline v0 {

/// A scene point and the blur that it should have on the film, at one moment.
struct FocusTarget {
  ScenePoint place;
  double blur_mm = 0;  ///< wanted diameter: 0 sharp; negative: in front of the plane of focus; positive: beyond it
  double weight = 1;   ///< of the squared error of the blur; 0: the blur is reported, but does not count
};

/// How a target was used.
enum class TargetUse : std::uint8_t {
  used,
  no_weight,
  not_finite,  ///< a coordinate, the blur or the weight is not finite, or the weight is negative
  no_image,    ///< behind the lens, within the front focal length, or imaged more than 1e9 focal lengths away
  outlier,     ///< the robust fit gave it no weight
  no_rays,     ///< exact rays: none from the target passes the lens
};

/// "used", "no_weight", ...
PETZVAL_API std::string_view name(TargetUse use) noexcept;

/// The blur of a target on a film.
struct TargetBlur {
  TargetUse use = TargetUse::used;
  double wanted_mm = 0;
  double blur_mm = 0;  ///< signed; NaN if the target has no image
};

/// How far targets determine the plane of focus.
enum class PlaneRank : std::uint8_t {
  none,   ///< no targets of weight
  point,  ///< one, or several in one place of the picture: its depth only
  line,   ///< two, or several on a line of the picture: its depth and the slope along that line
  plane,
};

/// "none", "point", "line", "plane".
PETZVAL_API std::string_view name(PlaneRank rank) noexcept;

}  // namespace petzval::inline v0
