// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "core/scalar.hpp"
#include "core/simd.hpp"

namespace petzval::blur_detail {

/// Stands for the inverse depth of a surface behind the ray if the pixel has no such surface.
inline constexpr float no_surface = -1e30f;

// Anonymous namespace: the code is compiled for several instruction sets, and the linker must not merge the versions.
namespace {

using kernel::select;
template <class T>
PETZVAL_INLINE T size_of(T x) noexcept {
  return select(x < T(0.0f), -x, x);
}

/// The largest integer at or below x, after x is rounded to 1/256 px: rays of regular pupils pass exactly between two
/// pixels at half a step, and rounding errors must not select the pixel.
template <class T>
struct WholePixel {
  static PETZVAL_INLINE T below(T x) noexcept { return std::floor(std::floor(256 * x + 0.5) / 256); }
};

/// The pixels that a line passes as its inverse depth decreases, by steps along the direction of the larger slope. A
/// step ends where the line leaves the pixel. Each inverse depth therefore belongs to one step, and a surface is met in
/// the pixel that the line passes at the depth of the surface.
///
/// Positions are relative to the centre of pixel (0, 0). T: double, or lanes of float.
template <class T>
class PixelSteps {
 public:
  /// The line at + slope w from inverse depth `from` to `to`.
  /// @param farthest, nearest limits of all surfaces; nearest > 0
  PETZVAL_INLINE PixelSteps(T at_x, T at_y, T slope_x, T slope_y, T from, T to, T farthest, T nearest) noexcept
      : along_columns_(size_of(slope_x) >= size_of(slope_y)), farthest_(farthest), nearest_(nearest) {
    const T at = select(along_columns_, at_x, at_y), zero(0.0f), one(1.0f), half(0.5f);
    other_at_ = select(along_columns_, at_y, at_x), other_slope_ = select(along_columns_, slope_y, slope_x);
    T slope = select(along_columns_, slope_x, slope_y);
    const T least = T(1e-6f) / nearest;  // if a line has nearly no slope, one step covers all depths
    slope = select(size_of(slope) < least, least, slope);
    towards_ = select(slope > zero, -one, one);
    // The margin exceeds rounding errors: the first step begins before `from`, the last step ends after `to`.
    const T margin(1.0f / 64);
    first_ = WholePixel<T>::below(at + slope * from + half - towards_ * margin);
    last_ = size_of(WholePixel<T>::below(at + slope * to + half + towards_ * margin) - first_);
    length_ = one / size_of(slope), middle_ = (first_ - at) / slope;
  }

  /// The last step; the first step is 0.
  PETZVAL_INLINE T last() const noexcept { return last_; }
  /// Inverse depths in a step lie between low(n) and low(n - 1).
  PETZVAL_INLINE T low(T n) const noexcept { return middle_ - (n + T(0.5f)) * length_; }
  /// Range of inverse depths of a step.
  PETZVAL_INLINE T length() const noexcept { return length_; }
  /// The pixel of a step, relative to pixel (0, 0), in whole numbers.
  struct Pixel {
    T column, row;
    T beyond;  ///< position across the main direction beyond the edge of the pixel
  };
  PETZVAL_INLINE Pixel pixel(T n) const noexcept {
    // The middle of a step, clamped to the depths of the scene: a line that moves by less than a pixel stays in its
    // pixel.
    T w = middle_ - n * length_;
    w = select(w < farthest_, farthest_, w), w = select(w > nearest_, nearest_, w);
    const T main = first_ + towards_ * n, across = other_at_ + other_slope_ * w + T(0.5f),
            other = WholePixel<T>::below(across);
    return {select(along_columns_, main, other), select(along_columns_, other, main), across - other};
  }

 private:
  decltype(T(0) < T(0)) along_columns_;
  T other_at_, other_slope_, farthest_, nearest_;
  T towards_;  ///< change of the pixel along the main direction in a step, 1 or -1
  T first_, last_, middle_, length_;
};

}  // namespace
}  // namespace petzval::blur_detail
