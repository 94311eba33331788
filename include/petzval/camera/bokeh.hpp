// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/iris/iris.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval {

/// Artistic controls of the bokeh of a Camera; the defaults change nothing.
///
/// Every ray model supports the controls. Names and formulas follow "Recreating realistic bokeh by biasing lens-sample
/// positions", 2017. Film samples are distributed by the weights; the importance of rays from the scene includes the
/// weights.
///
/// Accuracy: exact models and polynomials weight the points of the real stop; a weight on a narrow ring is
/// off by up to 2 % at f/1.35. Polynomials keep the irradiance within 1 % for distributions up to 200 and are 8 % too
/// bright at 1000.
///
/// Limitations: the model thin_two_disc with a round stop, and lenses whose stop has no rim apply the weights
/// to the clipped pupil of each film point, so that a cat's eye gets a bright rim of its own. The other
/// first-order models apply them to the paraxial image of the stop.
struct BokehControls {
  int blades = 0;  ///< number of straight blades, 3 to 20; 0: the iris of the lens
  /// Radius of a second rim that clips the pupils to cat's eyes, divided by the radius of the pupil on the axis. (The
  /// program in the source uses 1 / sqrt of this number.) A Camera throws Error for such a rim if the lens has
  /// cylinders, and in exact models and polynomials if it has a central obscuration.
  double lens_ratio = 1;
  /// Displacement of the second rim, opposite to the film point, at half of the longer side of the film from the axis;
  /// in pupil radii on the axis. The displacement per mm is equal in all directions, so that cat's eyes are symmetric
  /// about the axis on every film. A Camera throws Error if the rim moves by more than 1e6 radii over the film.
  double rate_of_change = 0;
  /// true: the weights compensate for the pupil area that the rim clips. false: the irradiance falls with the area.
  /// Limitations: a clipped pupil sees the film at other angles. With half of the pupil left, the compensated
  /// irradiance is still 12 % too low at f/2 and 30 % at f/1.1.
  bool keep_light = false;
  double weight_distribution = 0, weight_strength = 0.5;  ///< as in EdgeWeight
  IrisMap weight_map{};                                   ///< empty: no map

  /// True if the second rim clips pupils.
  bool vignettes() const noexcept { return lens_ratio != 1 || rate_of_change != 0; }
  EdgeWeight edge() const noexcept { return {weight_distribution, weight_strength}; }
};

/// Two discs whose overlap approximates the pupils of a lens's film points, in the terms of BokehControls. The smaller
/// disc is the pupil, the larger one the second rim.
struct TwoDiscs {
  double lens_ratio = 1;
  /// For a film whose longer side is 2 * film_radius; negative if the larger disc moves in the direction of the film
  /// point.
  double rate_of_change = 0;
  /// Area between the edges of pupil and overlap, divided by the pupil's area, at these distances from the axis: equal
  /// steps of film area from 0 to the end of the light. For edges that cross, as of thin cat's eyes, distances along
  /// the normals count.
  std::vector<double> film_mm, errors;
  double error = 0;  ///< mean of errors
};

/// Fits two discs to the pupils of a lens with its stop taken as round.
///
/// ModelKind::thin_two_disc uses the same fit, scaled to the exact exposure.
///
/// @param lens         the lens
/// @param film_radius  largest distance of a film point from the axis (mm); above 0
/// @param wavelength   a compiled wavelength
/// @throws Error       if the lens has cylinders, has no pupils or passes no light, if the wavelength is not compiled,
///                     or if film_radius is not positive and finite
///
/// Accuracy: the mean error is below 3 % for the double Gauss 100 mm f/2 and f/1.35 and a Tessar on 36 x 24 mm, and for
/// a fisheye of 156 degrees up to 11 mm (tests/camera/two_discs_test.cpp). Faster or shorter lenses have 3 to 5 %. If
/// the light ends within the film, or pupils move as in a fisheye of 180 degrees, it is 5 to 7 %.
///
/// Limitations: the fit holds for film points. A far scene point sees a larger pupil, and its blur has the shape of
/// this pupil. The area on the axis is 3 % (Tessar 100 mm f/2.8), 6 % (double Gauss 100 mm f/2) or 14 % (f/1.35) too
/// large, because the real pupil of a corrected lens is a sphere about the focus and not a disc. Over the field, the
/// area between the edges of both is 3 to 18 % of the pupil's area.
PETZVAL_API TwoDiscs fit_two_discs(const Lens& lens, double film_radius, Wavelength wavelength = {});

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

}  // namespace petzval
