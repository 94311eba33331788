// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "petzval/analysis/lens_distortion.hpp"
#include "petzval/core/export.hpp"

namespace petzval {

/// Which picture a distortion model starts from.
enum class BrownConradyDirection : std::uint8_t {
  to_undistorted,  ///< from the lens's picture to the pinhole's: what OpenTrackIO takes where no model is named
  to_distorted,    ///< from the pinhole's picture to the lens's: OpenCV
};

/// "Brown-Conrady D-U" or "Brown-Conrady U-D", as OpenTrackIO and Unreal name the models.
PETZVAL_API std::string_view name(BrownConradyDirection direction) noexcept;

enum class RadialForm : std::uint8_t {
  polynomial,  ///< k1 to k3; the others are 0
  rational,    ///< k1 to k6, of which the last ones are 0 where that is better
};

/// The radial distortion of a lens as the polynomials of Brown and Conrady in the order of OpenCV and Unreal:
///
///     r' = r (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
///
/// r is the distance from the centre of projection over the focal length of the pinhole. The tangential terms p1 and p2
/// of a lens of revolution on an upright film are 0.
struct PETZVAL_API BrownConrady {
  BrownConradyDirection direction = BrownConradyDirection::to_undistorted;
  std::array<double, 6> k{};  ///< k1 to k6
  Pinhole pinhole;
  double rms_px = 0;      ///< of the errors at 33 x 33 places of the film, without dark ones
  double largest_px = 0;  ///< of those errors
  /// The widest field among these places, as the pinhole sees it: the coefficients are fitted up to there.
  double field_rad = 0;
  /// The field up to which r' rises with r, at most the field of 4 times the largest radius of the film: beyond it the
  /// coefficients fold the picture or have a pole.
  double rises_to_rad = 0;

  /// r' of r.
  double radius(double r) const noexcept;
};

struct BrownConradyOptions {
  BrownConradyDirection direction = BrownConradyDirection::to_undistorted;
  RadialForm form = RadialForm::rational;
};

/// Fits the coefficients by least squares over the film, in pixels of the picture that they lead to, with the scale on
/// the axis as it is.
///
/// Forms of 1 to 3 terms in the numerator and 0 to 3 in the denominator are tried. Of the
/// forms whose r' rises up to 1.25 times the largest radius of the film, the form with the least error is taken. If its
/// RMS error is above 0.001 pixels and more than twice the error of a form without pole up to 1.1 times that radius,
/// the latter is taken; rises_to_rad gives its range. No term exceeds 100 at the largest radius.
///
/// Throws Error for lenses with cylinders and tilted films, whose distortion is not radial; for fisheyes, whose film
/// sees fields of 88 degrees and more: no picture of a pinhole holds them; and for a dark film. st_maps() has the first
/// three.
PETZVAL_API BrownConrady fit_brown_conrady(const LensDistortion& distortion, const BrownConradyOptions& options = {});

}  // namespace petzval
