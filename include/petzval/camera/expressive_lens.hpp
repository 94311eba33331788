// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// The refractive power of a ring of the pupil.
struct PowerKnot {
  double radius = 0;  ///< over that of the pupil: 0 (axis) to 1 (rim)
  double power = 1;   ///< over that of the lens: above 1, rays of the ring cross the axis nearer to the lens
};

/// How far a place of the film is moved along the axis.
struct FilmOffset {
  FilmPoint place{};
  double offset_mm = 0;  ///< positive: away from the lens, so that nearer objects are sharp there
  double weight = 1;     ///< 0 or more: against the other places
};

/// Aberrations as an artist sets them, for first-order models: sources, signs and amounts are free, and a real lens can
/// be where they start (expressive_from).
///
///     ExpressiveLens bent = expressive_from(lens);
///     for (PowerKnot& knot : bent.power) knot.power = 1 + 3 * (knot.power - 1);
///     const Camera camera(lens, film, {.model = ModelKind::thick, .expressive = bent});
///
/// This has three times the spherical aberration of the lens.
///
/// A ray through the pupil at the radius rho (after the extent of a focal surface has scaled it), of the film point X
/// and the wavelength l, runs through the place of the chief ray of X where 1 / distance is
///
///     w(X) + (k(rho) - 1) / F + strength(l) (w(X, l) - w(X)),
///
/// distances counted along the axis from the entrance pupil, F the focal length, k the spline of power, and w(X) what
/// the moved film or the focal surface has in focus at the primary wavelength, w(X, l) at its own. Chief rays stay: the
/// aberrations have no distortion and no lateral colour of their own.
///
/// Source: Lee, Eisemann, Seidel 2010, "Real-time lens blur effects and focus control", section 5.3.
struct ExpressiveLens {
  /// A cubic spline (continuous second derivative, flat at the first knot, without curvature at the last), constant on
  /// both sides. Up to 32 knots in the order of their radii, 0.001 apart or more; empty: even power. Steps between near
  /// knots overshoot.
  std::vector<PowerKnot> power{};
  /// A surface by moving least squares of planes, with weights that fall with the third power of the distance; limited
  /// to a span three times that of the offsets. Empty: none.
  std::vector<FilmOffset> film_offsets{};
  /// Of the lens's own axial colour: 1 keeps it, 0 takes it away. One for each compiled wavelength, one for all, or
  /// empty: 1.
  std::vector<double> dispersion{};

  /// Nothing is changed.
  bool empty() const noexcept { return power.empty() && film_offsets.empty() && dispersion.empty(); }
};

/// The spherical aberration on the axis and the curvature of field of a real lens as power and film offsets of its
/// first-order model, as far as its pupil, its image circle and this film's corners go, with a dispersion of 1; at the
/// lens's primary wavelength, f-number and focus. Offsets stand for the mean of both sections: astigmatism and coma are
/// left out. Where offsets grow beyond a fifth of the film's distance from the pupil they end.
///
/// The blur of out-of-focus points is within 5 % of the real one on the axis and within 6 % over the film, for a double
/// Gauss f/1.35 and f/1.8, a Tessar and a Petzval lens (tests/camera/expressive_lens_test.cpp). Lenses that a
/// first-order model does not fit, fisheyes above all, gain nothing. Throws Error where a Camera of the thick lens
/// does, and for cylinders.
PETZVAL_API ExpressiveLens expressive_from(const Lens& lens, const Film& film = {});

/// How steep the focus of a camera is over its film, where it is steepest: by how much, over their distance, the rays
/// of neighbouring film points through the rim of the pupil come nearer to each other.
struct FocalSteepness {
  double steepness = 0;  ///< below 1: every ray of the scene has one film point
  FilmPoint place{};
};

}  // namespace petzval
