// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "line_extents.hpp"
#include "pupil/pupil_boundary.hpp"

namespace petzval::pupil_detail {

/// A pupil during the search: middle, half axes and, for each direction, the interval of passing rays from the middle
/// to `to`, minus one obscuration and other gaps. to = 0: no ray passes in this direction. Without directions no ray
/// passes.
struct Found {
  struct Ends {
    double obscured_from = 0, obscured_to = 0, to = 0;
    double slope = 0;  // d clearance / d radius at `to`; 0 if unknown
  };
  Vec2<double> middle{0, 0}, half_axes{0, 0};
  std::vector<Ends> ends;
  std::vector<std::vector<Gap>> gaps;  // by direction; empty if there are no gaps

  bool empty() const noexcept { return ends.empty(); }
};

/// Moves the origin of a pupil to its centre if the search started far from the centre.
/// @param units unit vectors of the directions
/// @return false and changes nothing if the origin is close to the centre or a direction is obscured
bool recentre(Found& found, std::span<const Vec2<double>> units);

PupilRegion region_of(const Found& found, std::span<const Vec2<double>> units);

/// Interpolates halfway between two pupils, also with the next pupil on either side if the search found it.
class Interpolation {
 public:
  Interpolation(const Found& far_before, const Found& before, const Found& after, const Found& far_after) noexcept
      : found_{usable(far_before), &before, &after, usable(far_after)} {
    const bool left = found_[0], right = found_[3];  // Lagrange's weights
    weights_ = left && right ? std::array{-1. / 16, 9. / 16, 9. / 16, -1. / 16}
               : left        ? std::array{-1. / 8, 6. / 8, 3. / 8, 0.}
               : right       ? std::array{0., 3. / 8, 6. / 8, -1. / 8}
                             : std::array{0., 1. / 2, 1. / 2, 0.};
  }

  template <class Value>
  double operator()(const Value& value) const noexcept {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (found_[i]) sum += weights_[i] * value(*found_[i]);
    }
    return sum;
  }
  /// Interpolates a non-negative value; the mean of both neighbours if one of them is 0 or the values change too fast.
  template <class Value>
  double positive(const Value& value) const noexcept {
    const double sum = (*this)(value), a = value(*found_[1]), b = value(*found_[2]);
    return sum > std::min(a, b) / 2 && sum < 2 * std::max(a, b) ? sum : (a + b) / 2;
  }

 private:
  static const Found* usable(const Found& found) noexcept {
    return found.empty() || !found.gaps.empty() ? nullptr : &found;
  }

  std::array<const Found*, 4> found_;
  std::array<double, 4> weights_;
};

}  // namespace petzval::pupil_detail
