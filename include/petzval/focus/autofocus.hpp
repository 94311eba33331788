// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/focus/focus_point.hpp"
#include "petzval/focus/image_rays.hpp"

namespace petzval {

enum class AutofocusStatus : std::uint8_t {
  solved,
  no_targets,   ///< no target can be used
  unreachable,  ///< the film would not lie behind the lens
};

/// "solved", "no_targets", "unreachable".
PETZVAL_API std::string_view name(AutofocusStatus status) noexcept;

/// The upright film that serves focus targets best.
struct Autofocus {
  AutofocusStatus status = AutofocusStatus::no_targets;
  Film film;                      ///< z_mm is set; unless solved, the film as it was given
  std::vector<TargetBlur> blurs;  ///< of each target on that film
  double rms_mm = 0;              ///< weighted RMS of the blur minus the wanted blur, over the targets used; 0 if none
  /// Relative growth of the image, by the paraxial chief ray through the exit pupil (of the ideal lens, for exact rays
  /// too): from infinity focus on the axis by the same criterion, as breathing(), and from the film as it was given.
  /// NaN if there is no such film, or if it lies in the exit pupil.
  double breathing = std::numeric_limits<double>::quiet_NaN();
  double magnification_change = std::numeric_limits<double>::quiet_NaN();

  explicit operator bool() const noexcept { return status == AutofocusStatus::solved; }
};

/// Least weighted squares of the blur minus the wanted blur, in closed form: the blur of a target is linear in the
/// position of the film.
///
/// film: its z_mm, if unset, is the rear focal point. Throws Error for a tilted film and for a z_mm that is not finite.
PETZVAL_API Autofocus autofocus(const IdealLens& lens, std::span<const FocusTarget> targets, const Film& film = {});

/// The same by exact rays. A wanted blur moves the film that a target asks for away from the sharpest one until the
/// blur has that size; a target that is nowhere that sharp asks for the sharpest film.
///
/// min_rms: least weighted squares of RMS blur, in closed form. min_max: least largest radius, each times its weight
/// (the largest weight as 1), to rounding; blurs are then twice the largest radius. film: its z_mm, if unset, is the
/// lens's film_z(). Throws Error for other criteria and for films as above.
///
/// Accuracy, of one target against solve_focus, which also traces the edges of pupils (tests/focus; double Gauss
/// 100 mm f/2, on the axis and to 11 degrees off): with 256 rays min_rms within 12 um and min_max within 80 um, with
/// 1024 rays 7 um and 60 um.
PETZVAL_API Autofocus autofocus(const ImageRays& lens, std::span<const FocusTarget> targets, const Film& film = {},
                                FocusCriterion criterion = FocusCriterion::min_rms);

/// A region to focus on, as columns x rows targets in the middles of equal parts of the parallelogram
/// centre +- half_width +- half_height (lens frame, mm). Throws Error unless columns and rows are 1 or more,
/// and for more than 2^20 targets.
PETZVAL_API std::vector<FocusTarget> region_targets(const Vec3<double>& centre, const Vec3<double>& half_width,
                                                    const Vec3<double>& half_height, int columns, int rows);

}  // namespace petzval
