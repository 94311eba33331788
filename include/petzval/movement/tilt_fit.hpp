// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/film/film.hpp"
#include "petzval/movement/disparity_fit.hpp"
#include "petzval/movement/focus_target.hpp"
#include "petzval/movement/ideal_lens.hpp"
#include "petzval/movement/image_rays.hpp"

namespace petzval::inline v0 {

struct TiltOptions {
  double max_tilt_rad = 0.3490658503988659;  ///< 20 degrees; between film and the plane across the axis
  bool robust = false;                       ///< outliers lose their weight: least median of squares, then Tukey's loss
  /// As it stands. The fit keeps the middle of its picture and its corners clear of the lens (of a film without size
  /// the middle alone), and gives it back where nothing can be solved. A place that is not set is the rear focal point
  /// of an ideal lens, and else the lens's own.
  Film film = {};
};

/// How a tilted film serves focus targets.
struct TiltFit {
  enum class Status : std::uint8_t {
    solved,        ///< the targets fix a plane
    least_tilt,    ///< they do not (see `rank`): the plane of least tilt among the best
    limited,       ///< the tilt limit holds; the best film within it
    no_targets,    ///< none that can be used: the film stays where it stood
    unreachable,   ///< the film would touch the lens: it stays where it stood
    not_converged  ///< the film stays where it stood
  };
  Status status = Status::no_targets;
  PlaneRank rank = PlaneRank::none;
  Film film;                        ///< shifted so that the middle of the picture stays; z_mm is set
  std::optional<FocusPlane> focus;  ///< nothing where all that is in focus is at infinity
  std::vector<TargetBlur> blurs;    ///< of each target, used or not
  double rms_mm = 0;                ///< weighted, of blur less wanted, over the targets used
  explicit operator bool() const noexcept { return status <= Status::limited; }
};
/// "solved", "least_tilt", ...
PETZVAL_API std::string_view name(TiltFit::Status status) noexcept;

/// Tilts and moves a film so that focus targets are as sharp, or as blurred, as they should be: least weighted squares
/// of the signed blur less the blur wanted. Starts from the plane of least squares in disparity; Ceres does the rest.
///
///     const IdealLens lens = thin_lens(50, 2);
///     const std::vector<FocusTarget> targets{{.place = {{-300, -200, -1500}}},
///                                            {.place = {{400, -100, -2500}}},
///                                            {.place = {{0, 300, -4000}}, .blur_mm = 0.05}};
///     const TiltFit fit = fit_tilt(lens, targets, {.film = {.width_mm = 36, .height_mm = 24}});
///     if (fit) draw(fit.film);
///
/// What targets do not fix is left as upright as it can be: one place in the picture gives an upright film, a line
/// the film of least tilt through it. Beyond the limit of tilt it is the best film on the limit. The film is continuous
/// in the targets, also where their plane comes to contain a line of sight: the limit of tilt goes to 0 where their
/// spread in the picture does, from 2 to 1 times one_place, and that across its main direction from 2 to 1 times
/// line_aspect.
///
/// Robust, of 5 targets or more: least median of squares over all groups of three (evenly thinned out beyond 24
/// targets), then Tukey's loss, 4.685 deviations wide. A target's weight has no say in whether it is an outlier. The
/// film may jump where another majority takes over; a third of all targets, all in one place that is off by a few
/// deviations only, may win one.
///
/// Accuracy (tests/movement): targets that can all be met give their film within 1e-9, in any unit from 1e-6 to 1e6,
/// for thin lenses and the thick ones of data/lenses; 24 points with 3 mm of noise, 8 of them anywhere else, their
/// plane within 1 degree. 24 targets take 0.03 ms, robust 0.3 ms (tests/bench). Throws Error for a limit that is not
/// from 0 to less than a quarter turn, and for a film that is not finite or of negative size.
PETZVAL_API TiltFit fit_tilt(const IdealLens& lens, std::span<const FocusTarget> targets,
                             const TiltOptions& options = {});
/// By exact rays: as above for the thick lens, and from there the least weighted squares of the bundles' diameters (see
/// BundleBlur). A target that should be blurred counts as one that should be sharp on a film so much nearer that
/// defocus makes the blur wanted, as for autofocus(). Contradictory wishes then have one answer, and it is continuous
/// but for single rays that come and go at a rim. Wants within the blur that aberrations leave on the sharpest upright
/// film count as sharp; those that can all be met are met within 1e-4 of themselves. Outliers, what the targets fix,
/// and the plane of focus are those of the thick lens: aberrations move the film, and hardly what is in focus. 24
/// targets of 256 rays take 1.5 ms, on the limit of tilt or within it.
PETZVAL_API TiltFit fit_tilt(const ImageRays& lens, std::span<const FocusTarget> targets,
                             const TiltOptions& options = {});

}  // namespace petzval::inline v0
