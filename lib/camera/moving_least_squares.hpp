// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "moving_least_squares_loops.hpp"
#include "petzval/camera/focal_surface.hpp"
#include "petzval/core/export.hpp"
#include "petzval/core/film.hpp"
#include "petzval/core/geometry.hpp"

namespace petzval::camera_detail {

/// A value at a place of the film.
struct WeighedValue {
  FilmPoint place;
  double value = 0;
  double weight = 1;  ///< 0 or more
  double fade = 1;    ///< from 0 (gone) to 1
};

/// Places of points lie within so many sides of the picture.
inline constexpr double reach_in_sides = 1e6;

/// Throws Error, which begins with `where`, for what MovingLeastSquares does not take.
void check(const WeighedValue& point, double side, const std::string& where);

/// A function of film places through values at some of them, by moving least squares: at each place the constant or the
/// plane that fits the values best, with weights that fall with the distance d to the power -beta.
///
/// Weights are alpha (m / r2)^(beta / 2) with r2 = d^2 + soft^2 and m the least r2, so that nothing overflows, and a
/// place at a point gives the point's value to the last bit (points in one place: their mean). alpha is weight times
/// fade. soft is 0 for points that count in full, and grows as a point fades, or as its alpha falls below a thousandth
/// of the largest, up to a tenth of the picture's side: a point that vanishes leaves no spike behind. Only ratios of
/// alphas count; points below 1e-9 of the largest are left out.
///
/// Planes of points on a line have the slope along it alone, those of points in one place none. Points count as on a
/// line where their RMS spread across it is below 0.02 of that along it, and as in a plane from 0.08 on; between, and
/// as a point fades, values blend, so that it leaves without a jump even if the others lie on a line. The result stays
/// within [least - m, most + m] of the values of the points, with m = `beyond` times most - least; points that fade
/// widen this in part.
///
/// Results are the same for all instruction sets and however places are batched; they are finite for any place, as
/// constants beyond 1e6 sides. Accuracy: planes are reproduced within 1e-13 of the range of values for beta up to 4,
/// and within 1e-11 for 8; floats are computed in double. Source: Lancaster and Salkauskas 1981; weights of Lee et al.
/// 2010, section 5.2.
class PETZVAL_API MovingLeastSquares {
 public:
  /// side: of the picture, mm: the root of its area. Throws Error, which begins with `where` and the number of the
  /// point from 1, for numbers that are not finite, places beyond 1e6 sides, negative weights and fades outside [0, 1];
  /// and for no points of weight, beta outside [1, 8], and a side that is not above 0.
  MovingLeastSquares(const std::string& where, std::span<const WeighedValue> points, double side, SurfaceKind kind,
                     double beta, double beyond = 1);

  double at(const FilmPoint& place) const noexcept;
  /// N places; out: N.
  void at(std::size_t count, const double* x, const double* y, double* out) const noexcept;
  void at(std::size_t count, const float* x, const float* y, float* out) const noexcept;
  /// The derivatives of at() by x and y. At a point: those of the plane there (beta 1 has a cusp there).
  Vec2<double> slopes(const FilmPoint& place) const noexcept;

  /// What results are within.
  double least() const noexcept { return low_ / to_scaled_value_; }
  double most() const noexcept { return high_ / to_scaled_value_; }
  /// Of the points, as they widen the limits.
  double least_value() const noexcept { return least_value_ / to_scaled_value_; }
  /// Keeps results within limits, which hold all values.
  void keep_within(double low, double high) noexcept;

 private:
  void find_line(std::span<const double> shares);
  LeastSquaresJob job() const noexcept;

  /// What counts of the points: places and values scaled by powers of two, weights against the heaviest point's, and
  /// squares of softness.
  struct Columns {
    std::vector<double> x, y, value, alpha, soft2;
  };

  bool affine_;
  double plane_ = 1;  ///< as in LeastSquaresJob
  Vec2<double> along_{1, 0};
  FallingPower power_{};  ///< beta / 2
  double to_scaled_ = 1, to_scaled_value_ = 1;
  Columns points_;
  double low_ = 0, high_ = 0, least_value_ = 0;  ///< of the result, scaled
};

}  // namespace petzval::camera_detail
