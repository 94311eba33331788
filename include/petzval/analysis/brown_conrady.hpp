// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "petzval/analysis/lens_distortion.hpp"
#include "petzval/core/export.hpp"

namespace petzval {

/// The direction in which a distortion model maps image positions.
enum class BrownConradyDirection : std::uint8_t {
  to_undistorted,  ///< from the lens image to the pinhole image: the default of OpenTrackIO if no model is named
  to_distorted,    ///< from the pinhole image to the lens image: OpenCV
};

/// "Brown-Conrady D-U" or "Brown-Conrady U-D", the names in OpenTrackIO and Unreal.
PETZVAL_API std::string_view name(BrownConradyDirection direction) noexcept;

enum class RadialForm : std::uint8_t {
  polynomial,  ///< k1 to k3; the others are 0
  rational,    ///< k1 to k6; unused denominator terms are 0
};

/// Radial distortion of a lens in the Brown-Conrady form, with the coefficient order of OpenCV and Unreal.
///
///     r' = r (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
///
/// r is the distance from the centre of projection divided by the focal length of the pinhole. The tangential terms p1
/// and p2 are 0, because only rotationally symmetric lenses on an upright film can be fitted.
struct PETZVAL_API BrownConrady {
  BrownConradyDirection direction = BrownConradyDirection::to_undistorted;
  std::array<double, 6> k{};  ///< k1 to k6
  Pinhole pinhole;
  double rms_px = 0;      ///< RMS error over a grid of 33 x 33 film points, dark film points left out
  double largest_px = 0;  ///< largest error on the same grid
  /// Largest pinhole field angle on that grid: the limit of the fitted range.
  double field_rad = 0;
  /// Pinhole field angle up to which r' increases with r. Beyond it the coefficients fold the image or have a pole.
  /// Searched up to 4 times the largest radius on the film.
  double rises_to_rad = 0;

  /// Maps a radius r to r'.
  double radius(double r) const noexcept;
};

struct BrownConradyOptions {
  BrownConradyDirection direction = BrownConradyDirection::to_undistorted;
  RadialForm form = RadialForm::rational;
};

/// Fits Brown-Conrady coefficients to a lens by least squares over the film.
///
/// The errors are measured in pixels of the target image; the scale on the axis is kept. Forms with 1 to 3 terms in the
/// numerator and 0 to 3 in the denominator are tried. The form with the least error whose r' increases up to 1.25 times
/// the largest radius on the film is preferred. If its RMS error is above 0.001 pixels and more than twice the error of
/// another form without a pole up to 1.1 times that radius, the other form is taken; rises_to_rad gives its range.
/// No term exceeds 100 at the largest radius.
///
/// @param distortion  the lens, camera and pinhole
/// @param options     direction and form
/// @return            the coefficients and their errors
/// @throws Error      if the lens has cylindrical surfaces or the film is tilted (distortion is not radial), if the
///                    film sees fields above 88 degrees (fisheyes exceed a pinhole image), or if the film is dark
///
/// st_maps() supports cylindrical surfaces, tilted films and fisheyes.
PETZVAL_API BrownConrady fit_brown_conrady(const LensDistortion& distortion, const BrownConradyOptions& options = {});

}  // namespace petzval
