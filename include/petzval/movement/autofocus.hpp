// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/vec.hpp"
#include "petzval/film/film.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/movement/focus_target.hpp"
#include "petzval/movement/image_rays.hpp"

namespace petzval::inline v0 {

/// An upright film that serves focus targets.
struct Autofocus {
  enum class Status : std::uint8_t {
    solved,
    no_targets,   ///< none that can be used
    unreachable,  ///< the film would not lie behind the lens
  };
  Status status = Status::no_targets;
  Film film;                      ///< where it stood, unless solved; z_mm is set
  std::vector<TargetBlur> blurs;  ///< of each target on that film
  double rms_mm = 0;              ///< weighted, of blur less wanted, over the targets used; 0 without any
  /// How much larger the image has become, as a fraction, by the paraxial chief ray through the exit pupil (of the
  /// ideal lens, for exact rays too): against focus at infinity on the axis by the same criterion, as breathing() has
  /// it, and against the film before. NaN where there is none to compare with: that stood in the exit pupil.
  double breathing = std::numeric_limits<double>::quiet_NaN();
  double magnification_change = std::numeric_limits<double>::quiet_NaN();

  explicit operator bool() const noexcept { return status == Status::solved; }
};

/// "solved", "no_targets", "unreachable".
PETZVAL_API std::string_view name(Autofocus::Status status) noexcept;

/// Least weighted squares of blur less wanted, in closed form: the blur of a target is linear in the film's position.
/// film: as it stands; a place that is not set is the rear focal point. Throws Error for a tilted film and a place that
/// is not finite.
PETZVAL_API Autofocus autofocus(const IdealLens& lens, std::span<const FocusTarget> targets, const Film& film = {});

/// By exact rays; a place of the film that is not set is the lens's. A wanted blur moves the film that a target asks
/// for by as much as it takes to blur it so (where it is that sharp at all).
///
/// min_rms: least weighted squares of RMS blur, in closed form. min_max: least largest radius, each times its weight
/// (the largest weight as 1), to rounding; blurs are then twice the largest radius. Throws Error for other criteria and
/// films as above.
///
/// Accuracy, of one target against solve_focus, which sends rays to the edges of pupils too (tests/movement; double
/// Gauss 100 mm f/2, on the axis and to 10 degrees off): min_rms within 4 um; min_max within 50 um with 256 rays, 20 um
/// with 1024.
PETZVAL_API Autofocus autofocus(const ImageRays& lens, std::span<const FocusTarget> targets, const Film& film = {},
                                FocusCriterion criterion = FocusCriterion::min_rms);

/// A region to focus on as targets: columns x rows of them, in the middles of as many equal parts of the parallelogram
/// centre +- half_width +- half_height (lens frame, mm). Throws Error for none.
PETZVAL_API std::vector<FocusTarget> region_targets(const Vec3<double>& centre, const Vec3<double>& half_width,
                                                    const Vec3<double>& half_height, int columns, int rows);

}  // namespace petzval::inline v0
