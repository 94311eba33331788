// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/focus_plane.hpp"
#include "petzval/focus/focus_point.hpp"
#include "petzval/focus/image_rays.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

struct TiltOptions {
  double max_tilt_rad = 0.3490658503988659;  ///< 20 degrees; between the film and the plane across the axis
  bool robust = false;                       ///< outliers lose their weight: least median of squares, then Tukey's loss
  /// The film as it stands. The fit keeps the middle of its picture, keeps its corners behind the lens (for a film
  /// without size, its middle), and returns it if nothing can be solved. Its z_mm, if unset, is the rear focal point of
  /// an ideal lens, and the lens's film_z() for exact rays.
  Film film = {};
};

enum class TiltFitStatus : std::uint8_t {
  solved,        ///< the targets determine a plane
  least_tilt,    ///< they do not (see `rank`): the plane of least tilt among the best
  limited,       ///< the best film within the limit of tilt, and on it
  no_targets,    ///< no target can be used: the film stays
  unreachable,   ///< the film would touch the lens: it stays
  not_converged  ///< the film stays
};

/// "solved", "least_tilt", ...
PETZVAL_API std::string_view name(TiltFitStatus status) noexcept;

/// The tilted film that serves focus targets best.
struct TiltFit {
  TiltFitStatus status = TiltFitStatus::no_targets;
  PlaneRank rank = PlaneRank::none;
  Film film;                        ///< shifted so that the middle of the picture stays; z_mm is set
  std::optional<FocusPlane> focus;  ///< unset if the plane of focus is at infinity
  std::vector<TargetBlur> blurs;    ///< of each target, used or not
  double rms_mm = 0;                ///< weighted RMS of the blur minus the wanted blur, over the targets used

  explicit operator bool() const noexcept { return status <= TiltFitStatus::limited; }
};

/// Tilts and moves a film so that the blur of each focus target comes nearest to the wanted one: least weighted squares
/// of the signed blur minus the wanted blur. Starts from the least squares plane in inverse distance; Ceres refines it.
///
///     const IdealLens lens = thin_lens(50, 2);
///     const std::vector<FocusTarget> targets{{.place = {{-300, -200, -1500}}},
///                                            {.place = {{400, -100, -2500}}},
///                                            {.place = {{0, 300, -4000}}, .blur_mm = 0.05}};
///     const TiltFit fit = fit_tilt(lens, targets, {.film = {.width_mm = 36, .height_mm = 24}});
///     if (fit) draw(fit.film);
///
/// If the targets do not determine a plane, the film is as upright as possible: upright for targets in one place of the
/// picture, the film of least tilt for targets on a line of it. If the best film exceeds the limit of tilt, the result
/// is the best film on the limit. The film is continuous in the targets, also where their plane comes to contain a line
/// of sight: the limit of tilt falls to 0 as the RMS spread of the targets in the picture (x and y over depth) falls
/// from 2e-5 to 1e-5, and the limit across their main direction as the spread across falls from 4 % to 2 % of the
/// spread along it.
///
/// Robust, with 5 targets or more: least median of squares over all groups of three (a uniform subset of them beyond 24
/// targets), then Tukey's loss, 4.685 deviations wide. Whether a target is an outlier does not depend on its weight.
/// The film may jump where another majority takes over; a third of all targets, all in one place that is off by a few
/// deviations only, may win one.
///
/// Accuracy (tests/fit): if all targets can be met, the film is exact within 1e-9, in any unit from 1e-6 to 1e6,
/// for thin lenses and the thick ones of data/lenses; for 24 points with 3 mm of noise, 8 of them anywhere else, the
/// plane is within 1 degree. 24 targets take 0.03 ms, robust 0.3 ms (tests/bench). Throws Error unless the limit lies
/// from 0 to less than a quarter turn, and for a film that is not finite or of negative size.
PETZVAL_API TiltFit fit_tilt(const IdealLens& lens, std::span<const FocusTarget> targets,
                             const TiltOptions& options = {});

/// The same by exact rays: fits the thick lens as above and goes on from there to the least weighted squares of the
/// bundles' diameters (BundleBlur).
///
/// A target to be blurred counts as a target to be sharp on a film so much nearer that defocus makes the wanted blur,
/// as for autofocus(). So contradictory targets have one solution, continuous except where single rays come and go at a
/// rim. A wanted blur smaller than the aberrations on the sharpest upright film counts as sharp; blurs that can all be
/// met are met within 1e-4 of themselves. Outliers, rank and plane of focus are those of the thick lens: aberrations
/// move the film, and hardly what is in focus. 24 targets of 256 rays take 1.5 ms.
PETZVAL_API TiltFit fit_tilt(const ImageRays& lens, std::span<const FocusTarget> targets,
                             const TiltOptions& options = {});

}  // namespace petzval
