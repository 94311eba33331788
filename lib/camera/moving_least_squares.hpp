// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "moving_least_squares_loops.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/config.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval::camera_detail {

/// A value at a film point.
struct WeighedValue {
  FilmPoint film_point;
  double value = 0;
  double weight = 1;  ///< 0 or more
  double fade = 1;    ///< 0 (invisible) to 1
};

/// Largest coordinate of points, in sides of the picture.
inline constexpr double reach_in_sides = 1e6;

/// @throws Error  prefixed with `where` if MovingLeastSquares does not accept the point
void check(const WeighedValue& point, double side, const std::string& where);

/// Interpolates values at film points by moving least squares: at each position the constant or plane that fits the
/// values best, with weights that fall with the distance d to the power -beta. At a point it has exactly the value of
/// the point, or the mean value of coincident points.
///
/// Weights are alpha (m / r2)^(beta / 2) with r2 = d^2 + soft^2 and m the smallest r2, so that they do not overflow. A
/// point that fades, or whose alpha = weight * fade falls below 1e-3 of the largest alpha, becomes soft, up to a tenth
/// of the side, and vanishes without a jump. Only ratios of alphas matter; points below 1e-9 of the largest alpha are
/// left out. Points on a line determine only the slope along the line, coincident points no slope. Results stay within
/// [least - m, most + m] of the values, with m = `extrapolation` * (most - least); fading points widen these limits
/// slightly. Results are equal for all instruction sets and batch sizes, finite for any position, and constant beyond
/// 1e6 sides.
///
/// Accuracy: planes are reproduced within 1e-13 of the range of values for beta up to 4, within 1e-11 for 8. Floats are
/// computed in double. Sources: Lancaster and Salkauskas 1981; weights of Lee et al. 2010, section 5.2.
class PETZVAL_API MovingLeastSquares {
 public:
  /// @param where prefix of messages
  /// @param side square root of the area of the picture, mm
  /// @throws Error if numbers are not finite, coordinates exceed 1e6 sides, weights are negative, fades are outside
  ///               [0, 1], all weights are 0, beta is outside [1, 8], or side is not above 0
  MovingLeastSquares(const std::string& where, std::span<const WeighedValue> points, double side, SurfaceKind kind,
                     double beta, double extrapolation = 1);

  double at(const FilmPoint& film_point) const noexcept;
  /// Values at N positions.
  void at(std::size_t count, const double* x, const double* y, double* out) const noexcept;
  void at(std::size_t count, const float* x, const float* y, float* out) const noexcept;
  /// Derivatives of at() with respect to x and y. At a point they are the derivatives of the plane at this point (for
  /// beta = 1 the function has a cusp).
  Vec2<double> slopes(const FilmPoint& film_point) const noexcept;

  /// Limits of the results.
  double least() const noexcept { return low_ / to_scaled_value_; }
  double most() const noexcept { return high_ / to_scaled_value_; }
  /// Smallest value of the points; fading moves values towards the mean.
  double least_value() const noexcept { return least_value_ / to_scaled_value_; }
  /// Narrows the limits, which must contain all values.
  void keep_within(double low, double high) noexcept;

 private:
  void find_line(std::span<const double> presences);
  LeastSquaresJob job() const noexcept;

  /// The points with enough weight: coordinates and values scaled by powers of two, alphas relative to the largest,
  /// squared softness.
  struct Columns {
    std::vector<double> x, y, value, alpha, soft2;
  };

  bool affine_;
  double plane_ = 1;  ///< as in LeastSquaresJob
  Vec2<double> along_{1, 0};
  FallingPower power_{};  ///< beta / 2
  double to_scaled_ = 1, to_scaled_value_ = 1;
  Columns points_;
  double low_ = 0, high_ = 0, least_value_ = 0;  ///< limits of the result, scaled
};

}  // namespace petzval::camera_detail
