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

/// A focus point in the figure; one that takes no part is drawn hollow.
struct TiltFigurePoint {
  ScenePoint place;
  bool used = true;
};

/// A film before and after it was tilted, and what it is to serve.
struct TiltView {
  std::string_view title;       ///< the lens's name
  std::string_view remark;      ///< a line about the conditions, of which the figure knows nothing
  IdealLens lens;               ///< whose planes and lines these are
  const Lens* glass = nullptr;  ///< the real lens, cut open; without one a double arrow
  Film before, after;           ///< with their places; before upright
  /// What is in focus, where exact rays put the film elsewhere for it than `lens` does. Nothing: by `lens`.
  std::optional<FocusPlane> focus = {};
  double blur_mm = 0.03;  ///< largest blur that counts as sharp, > 0
  std::span<const TiltFigurePoint> points;
};

/// Film, lens and plane of focus seen from the side, as SVG text: the section that holds the axis and the
/// normal of the plane of focus, in which hinge line and Scheimpflug's line are points. Above the scene, below the lens
/// and its film, each to scale. Points lie where they are projected to along the hinge line, numbered
/// from 1.
///
/// What is sharp within blur_mm is a wedge with its edge on the hinge line: by the disc that a chief ray across the
/// film's normal would have, as signed_blur() has it. Throws Error for films that are not finite or without a place or
/// size, and a blur that is not above 0.
PETZVAL_API std::string tilt_figure(const TiltView& view);

}  // namespace petzval::inline v0
