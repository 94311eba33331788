// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval {

/// Options of fit_tilt().
struct TiltOptions {
  double max_tilt_rad = 0.3490658503988659;  ///< angle between the film and an upright film; 20 degrees
  bool robust = false;                       ///< true: ignore outliers, by least median of squares and Tukey's loss
  /// The initial film. The fit keeps the centre of its image, keeps its corners (its centre if it has no size) behind
  /// the lens, and returns it unchanged if there is no solution. If z_mm is unset, the film is at the rear focal point
  /// of an ideal lens, or at film_z() of the lens for exact rays.
  Film film = {};
  std::size_t rays = 256;  ///< exact rays: as in autofocus()
};

/// The result of fit_tilt().
struct TiltFit {
  /// solved, least_tilt or limited; or no_targets, unreachable or not_converged: the film is unchanged.
  FocusStatus status = FocusStatus::no_targets;
  PlaneRank rank = PlaneRank::none;
  Film film;                        ///< shifted to keep the centre of the image; z_mm is set
  std::optional<FocusPlane> focus;  ///< nullopt if the plane of focus is at infinity
  std::vector<TargetBlur> blurs;    ///< one per target, used or not
  double rms_mm = 0;                ///< weighted RMS of blur minus target blur, over the targets used

  explicit operator bool() const noexcept { return status <= FocusStatus::limited; }
};

/// Tilts and moves a film so that each focus target comes as close as possible to its target blur.
///
/// Minimises the weighted squares of the signed blur minus the target blur. Starts from the least-squares plane in
/// inverse distance, refined by Gauss-Newton steps.
///
///     const IdealLens lens = thin_lens(50, 2);
///     const std::vector<FocusTarget> targets{{.point = {{-300, -200, -1500}}},
///                                            {.point = {{400, -100, -2500}}},
///                                            {.point = {{0, 300, -4000}}, .blur_mm = 0.05}};
///     const TiltFit fit = fit_tilt(lens, targets, {.film = {.width_mm = 36, .height_mm = 24}});
///     if (fit) draw(fit.film);
///
/// If the targets do not determine a plane, the film is as upright as possible: upright for targets at a single image
/// position, of least tilt for targets on an image line. The film is continuous in the targets, even if their plane
/// approaches a line of sight, because the tilt limit falls to 0 for targets that are close together in the image.
///
/// Robust fitting needs 5 targets or more. Outliers do not depend on the weights. The film may jump if a different
/// majority of targets agrees.
///
/// @param lens     the lens
/// @param targets  scene points with their target blur and weight
/// @param options  tilt limit, robust fitting and initial film
/// @return         the film, or the unchanged initial film with a status
/// @throws Error   if the tilt limit is not in [0, 90) degrees, or the film is not finite or has a negative size
///
/// Accuracy (tests/fit): if all targets can be met, the film is exact within 1e-9, in any unit from 1e-6 to 1e6, for
/// thin lenses and the thick lenses of data/lenses. Robust, for 24 points with 3 mm of noise and 8 outliers among them,
/// the plane is within 1 degree. 24 targets take 0.03 ms, robust 0.3 ms (tests/bench).
///
/// Limitations: a third of all targets, all at one position that is off by only a few deviations, may win the majority.
PETZVAL_API TiltFit fit_tilt(const IdealLens& lens, std::span<const FocusTarget> targets,
                             const TiltOptions& options = {});

/// Tilts and moves a film with exact rays: minimises the weighted squares of the errors of ExactBlur diameters.
///
/// Starts from the fit of the thick lens, which also provides outliers, rank and plane of focus, because aberrations
/// move the film but hardly the plane of focus. As in autofocus(), a blurred target is treated as a sharp target on a
/// film displaced by the defocus of its target blur. Contradictory targets therefore have a single solution, continuous
/// unless single rays appear or vanish at a rim. A target blur below the aberrations on the sharpest upright film
/// counts as sharp.
///
/// Accuracy: target blurs that can all be met are met within a fraction of 1e-4. 24 targets of 256 rays take 1.5 ms.
PETZVAL_API TiltFit fit_tilt(const Lens& lens, std::span<const FocusTarget> targets, const TiltOptions& options = {});

}  // namespace petzval
