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
struct PupilEstimate {
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
bool recentre(PupilEstimate& found, std::span<const Vec2<double>> units);

PupilRegion region_of(const PupilEstimate& found, std::span<const Vec2<double>> units);

/// Interpolates halfway between two pupils, also with the next pupil on either side if the search found it.
class Interpolation {
 public:
  Interpolation(const PupilEstimate& far_before, const PupilEstimate& before, const PupilEstimate& after,
                const PupilEstimate& far_after) noexcept
      : estimates_{usable(far_before), &before, &after, usable(far_after)} {
    const bool left = estimates_[0], right = estimates_[3];  // Lagrange's weights
    weights_ = left && right ? std::array{-1. / 16, 9. / 16, 9. / 16, -1. / 16}
               : left        ? std::array{-1. / 8, 6. / 8, 3. / 8, 0.}
               : right       ? std::array{0., 3. / 8, 6. / 8, -1. / 8}
                             : std::array{0., 1. / 2, 1. / 2, 0.};
  }

  template <class Value>
  double operator()(const Value& value) const noexcept {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (estimates_[i]) sum += weights_[i] * value(*estimates_[i]);
    }
    return sum;
  }
  /// Interpolates a non-negative value; the mean of both neighbours if one of them is 0 or the values change too fast.
  template <class Value>
  double positive(const Value& value) const noexcept {
    const double sum = (*this)(value), a = value(*estimates_[1]), b = value(*estimates_[2]);
    return sum > std::min(a, b) / 2 && sum < 2 * std::max(a, b) ? sum : (a + b) / 2;
  }

 private:
  static const PupilEstimate* usable(const PupilEstimate& found) noexcept {
    return found.empty() || !found.gaps.empty() ? nullptr : &found;
  }

  std::array<const PupilEstimate*, 4> estimates_;
  std::array<double, 4> weights_;
};

}  // namespace petzval::pupil_detail
