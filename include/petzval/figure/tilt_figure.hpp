// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/movement/focus_plane.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval::inline v0 {

/// A focus point in the figure; a point that the fit did not use is drawn hollow.
struct TiltFigurePoint {
  ScenePoint place;
  bool used = true;
};

/// A film before and after a tilt, with its focus points.
struct TiltView {
  std::string_view title;       ///< the lens's name
  std::string_view remark;      ///< a line about the conditions
  IdealLens lens;               ///< its planes and lines are drawn
  const Lens* glass = nullptr;  ///< drawn as a section; a double arrow without it
  Film before, after;           ///< with their places; before upright
  /// The plane of focus, where it is not that of `lens`: exact rays put the film elsewhere. Unset: that of `lens`.
  std::optional<FocusPlane> focus = {};
  double blur_mm = 0.03;  ///< largest blur that counts as sharp, > 0
  std::span<const TiltFigurePoint> points;
};

/// Film, lens and plane of focus from the side, as SVG text: the section through the axis and the normal of the plane
/// of focus, in which the hinge line and the Scheimpflug line are points. The scene is drawn above, lens and film
/// below, each to scale. Focus points are projected along the hinge line and numbered from 1.
///
/// The region that is sharp within blur_mm is a wedge with its edge on the hinge line, by the blur that signed_blur()
/// gives. Throws Error for films that are not finite or have no place or size, and a blur that is not above 0.
PETZVAL_API std::string tilt_figure(const TiltView& view);

}  // namespace petzval::inline v0
