// SPDX-License-Identifier: Apache-2.0
// Loop of MovingLeastSquares over positions; moving_least_squares_loops.cpp defines it for each instruction set.
#pragma once

#include <cstddef>

#include "core/widest.hpp"

namespace petzval::camera_detail {

/// A power from 1/2 to 4; multiples of 1/2 are computed by products and a square root.
struct FallingPower {
  double exponent = 0.5;
  bool half = true;  ///< true: exponent = wholes + 1/2; false: exponent = wholes
  int wholes = 0;    ///< negative: any other exponent
};

/// Coordinates and values are scaled by powers of two, so that squares neither overflow nor underflow.
struct LeastSquaresJob {
  std::size_t points = 0;
  const double *x = nullptr, *y = nullptr, *value = nullptr;  ///< scaled
  const double *alpha = nullptr, *soft2 = nullptr;            ///< above 0, at most 1; 0 or more
  bool affine = true;
  double plane = 1, along_x = 1,
         along_y = 0;        ///< for affine surfaces: weight of the plane, and unit direction of the line
  FallingPower power{};      ///< beta / 2: the exponent for ratios of squared distances
  double low = 0, high = 0;  ///< limits of the result, scaled
  double to_scaled = 1, reach = 0, from_scaled = 1;
};

/// Computes the values `out` at `count` positions (mm).
struct LeastSquaresLoops {
  void (*values)(const LeastSquaresJob& job, std::size_t count, const double* x, const double* y, double* out) noexcept;
};

PETZVAL_WIDEST(LeastSquaresLoops, least_squares_loops)

}  // namespace petzval::camera_detail
