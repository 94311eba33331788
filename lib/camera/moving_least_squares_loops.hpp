// SPDX-License-Identifier: Apache-2.0
// The loops of MovingLeastSquares over places, which moving_least_squares_loops.cpp defines for each instruction set.
#pragma once

#include <cstddef>

#include "petzval/core/version.hpp"

namespace petzval::camera_detail {

/// Points and places in one type of number. Places and values are scaled by powers of two, which loses nothing, so that
/// squares neither overflow nor vanish.
///
/// Each number of a point stands there for 16 bytes side by side, so that instruction sets without loads that spread
/// one number over the lanes read it at once.
template <class R>
struct LeastSquaresJob {
  static constexpr std::size_t copies = 16 / sizeof(R);

  std::size_t points = 0;
  const R *x = nullptr, *y = nullptr, *value = nullptr;  ///< scaled
  const R *alpha = nullptr, *soft2 = nullptr;            ///< above 0, at most 1; 0 or more
  bool soft = false;                                     ///< any soft2 is above 0
  bool affine = true;
  R plane = 1, along_x = 1, along_y = 0;  ///< affine: the part that planes have, and the direction of lines (unit)
  bool odd = false;                       ///< beta is 2 wholes + 1, or 2 wholes
  int wholes = 0;                         ///< negative: any other beta, twice half_beta
  R half_beta = 0;
  R low = 0, high = 0;  ///< of the result, scaled
  R to_scaled = 1, reach = 0, from_scaled = 1;
  std::size_t count = 0;
  const R *at_x = nullptr, *at_y = nullptr;  ///< mm
  R* out = nullptr;
};

struct LeastSquaresLoops {
  void (*in_float)(const LeastSquaresJob<float>&) noexcept;
  void (*in_double)(const LeastSquaresJob<double>&) noexcept;
};

extern const LeastSquaresLoops least_squares_loops_baseline, least_squares_loops_avx2, least_squares_loops_avx512;

/// The same at a single place, in less time, for some numbers of points: moving_least_squares_one.cpp.
inline constexpr std::size_t most_points_of_one = 128;
bool least_squares_takes_one(std::size_t points) noexcept;
/// job: each number of a point stands there once; count, at_x, at_y and out are not read.
double least_squares_of_one(const LeastSquaresJob<double>& job, double at_x, double at_y) noexcept;

}  // namespace petzval::camera_detail
