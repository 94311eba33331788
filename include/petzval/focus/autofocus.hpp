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

/// The result of autofocus().
enum class AutofocusStatus : std::uint8_t {
  solved,
  no_targets,   ///< no target is usable
  unreachable,  ///< the solution does not lie behind the lens
};

/// "solved", "no_targets", "unreachable".
PETZVAL_API std::string_view name(AutofocusStatus status) noexcept;

/// The upright film that fits a set of focus targets best.
struct Autofocus {
  AutofocusStatus status = AutofocusStatus::no_targets;
  Film film;                      ///< the solution, with z_mm set; the given film if there is no solution
  std::vector<TargetBlur> blurs;  ///< for each target, its blur on this film
  double rms_mm = 0;              ///< weighted RMS difference of blur and requested blur; 0 if no target was used
  /// Relative growth of the image on this film, compared with the film for infinity (breathing; same criterion, on the
  /// axis) and with the given film (magnification_change). It follows the paraxial chief ray through the exit pupil,
  /// for exact rays as well. NaN if the film to compare with does not exist or lies in the exit pupil.
  double breathing = std::numeric_limits<double>::quiet_NaN();
  double magnification_change = std::numeric_limits<double>::quiet_NaN();

  explicit operator bool() const noexcept { return status == AutofocusStatus::solved; }
};

/// Finds the film with the least weighted squares of blur minus requested blur, for an ideal lens.
///
/// The solution is in closed form: the blur of a target is linear in the position of the film.
///
/// @param lens     the lens
/// @param targets  scene points and their requested blurs
/// @param film     the film to move; if z_mm is not set, it starts at the rear focal point
/// @throws Error   if the film is tilted, or if its z_mm is not finite
PETZVAL_API Autofocus autofocus(const IdealLens& lens, std::span<const FocusTarget> targets, const Film& film = {});

/// Finds the film that fits focus targets best, by exact rays.
///
/// The preferred film of a target is displaced from its sharpest film until the blur has the requested size. If the
/// smallest blur is larger than requested, the preferred film is the sharpest film.
///
/// @param lens       the lens
/// @param targets    scene points and their requested blurs
/// @param film       the film to move; if z_mm is not set, it starts at Lens::film_z()
/// @param criterion  min_rms: least weighted squares of the RMS blur, in closed form. min_max: smallest maximum of the
///                   weighted radii (the largest weight counts as 1), to rounding; blurs are twice the maximum radius.
/// @throws Error     if `criterion` is another one, if the film is tilted, or if its z_mm is not finite
///
/// Accuracy: solve_focus() also traces the edges of pupils. With one target, the difference is at most 12 um (min_rms)
/// and 80 um (min_max) with 256 rays, 7 um and 60 um with 1024 rays (tests/focus; double Gauss 100 mm f/2, on the axis
/// and up to 11 degrees off axis).
PETZVAL_API Autofocus autofocus(const ImageRays& lens, std::span<const FocusTarget> targets, const Film& film = {},
                                FocusCriterion criterion = FocusCriterion::min_rms);

/// A grid of targets that covers a parallelogram to focus on.
///
/// The parallelogram is centre +- half_width +- half_height (lens frame, mm). It is divided into columns x rows equal
/// cells with a target at the centre of each.
///
/// @throws Error unless `columns` and `rows` are at least 1 and their product is at most 2^20
PETZVAL_API std::vector<FocusTarget> region_targets(const Vec3<double>& centre, const Vec3<double>& half_width,
                                                    const Vec3<double>& half_height, int columns, int rows);

}  // namespace petzval
