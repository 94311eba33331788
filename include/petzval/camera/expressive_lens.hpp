// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// Relative refractive power at one radius of the pupil.
struct PowerKnot {
  double radius = 0;  ///< fraction of the pupil's radius: 0 (axis) to 1 (rim)
  double power = 1;   ///< fraction of the lens's power; above 1, rays cross the axis nearer to the lens
};

/// Axial offset of the film at one film point.
struct FilmOffset {
  FilmPoint film_point{};
  double offset_mm = 0;  ///< positive: away from the lens, so that nearer objects are in focus
  double weight = 1;     ///< relative to the other offsets; at least 0
};

/// Aberrations of any sign and amount for first-order models; fit_expressive_lens() starts from a real lens.
///
///     ExpressiveLens bent = fit_expressive_lens(lens);
///     for (PowerKnot& knot : bent.power) knot.power = 1 + 3 * (knot.power - 1);
///     const Camera camera(lens, film, {.model = ModelKind::thick, .expressive = bent});
///
/// This triples the spherical aberration. A ray of film point X and wavelength l at radius rho of the pupil (as scaled
/// by a focal surface) meets the chief ray of X at w(X) + (k(rho) - 1) / F + dispersion(l) (w(X, l) - w(X)) (1/mm along
/// the axis from the entrance pupil), with the focal length F, the spline k of power, and w, the inverse distance in
/// focus, at the primary wavelength and at l. Chief rays stay: distortion and lateral colour do not change.
///
/// Experimental: the interface may change in any version.
///
/// Source: Lee, Eisemann, Seidel 2010, "Real-time lens blur effects and focus control", section 5.3.
struct ExpressiveLens {
  /// Knots of a cubic spline: up to 32, sorted by radius, at least 0.001 apart; empty: uniform power. The spline has a
  /// continuous second derivative, slope 0 at the first knot and curvature 0 at the last, and is constant outside the
  /// knots. It overshoots at steps between close knots.
  std::vector<PowerKnot> power{};
  /// Offsets interpolated by moving least squares with planes and weights 1 / distance^3, limited to three times the
  /// range of the offsets; empty: no offset.
  std::vector<FilmOffset> film_offsets{};
  /// Factors of the lens's axial colour (1 keeps, 0 removes the colour): a factor per compiled wavelength, or a single
  /// factor; empty: 1.
  std::vector<double> dispersion{};

  /// True if the lens is unchanged.
  bool empty() const noexcept { return power.empty() && film_offsets.empty() && dispersion.empty(); }
};

/// Spherical aberration and field curvature of a real lens, as power and film offsets of its first-order model.
///
/// Evaluated at the primary wavelength, f-number and focus of the lens, within its pupil, its image circle and the
/// corners of the film. Offsets end if they exceed a fifth of the distance between film and pupil.
///
/// @throws Error  if a Camera of the thick model does, or the lens has cylinders
///
/// Accuracy: the blur of out-of-focus points is within 5 % on the axis and 6 % over the film, for a double Gauss f/1.35
/// and f/1.8, a Tessar and a Petzval lens (tests/camera/expressive_lens_test.cpp).
///
/// Limitations: offsets are the mean of the tangential and the sagittal section; astigmatism and coma are left out.
/// Lenses far from first order, such as fisheyes, gain nothing.
PETZVAL_API ExpressiveLens fit_expressive_lens(const Lens& lens, const Film& film = {});

/// Largest steepness of a camera's focus over the film.
///
/// The steepness at a film point is the relative decrease of the distance between rays of neighbouring film points
/// through the rim of the pupil.
struct FocalSteepness {
  double steepness = 0;  ///< below 1: every ray of the scene has one film point
  FilmPoint film_point{};
};

}  // namespace petzval
