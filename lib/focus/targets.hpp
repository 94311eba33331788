// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "petzval/core/config.hpp"
#include "petzval/focus/autofocus.hpp"

namespace petzval::focus_detail {

/// True if a target has no NaN, no infinity except z = -inf, and no negative weight.
PETZVAL_API bool well_formed(const FocusTarget& target) noexcept;

/// Largest absolute extent of the depth of field, in stops.
inline constexpr double largest_extent = 20;
/// Throws Error, prefixed with `where`, if abs(stops) > largest_extent.
void check_extent(double stops, const std::string& where);

/// Throws the errors of focus_targets().
void check_points(std::span<const FocusPoint> points, const FocusTime& moment);
/// The target of a checked point at a moment, even if the point is not valid at this moment. nullopt if it has no image
/// on the film of the moment.
std::optional<FocusTarget> target_at(const IdealLens& lens, const FocusPoint& point, const FocusTime& moment);
/// Applies FocusTime::nearer_weighs_more.
PETZVAL_API void weigh_nearer_more(const IdealLens& lens, std::span<FocusTarget> targets);

/// Largest distance of a film from the rear focal point, in focal lengths. The image of a point in the front focal
/// plane, or far off the axis, is farther away.
inline constexpr double farthest_film = 1e9;

/// Pupil size for an extent of the depth of field in stops, relative to an extent of 0.
template <class T>
T pupil_scale(T extent_stops) noexcept {
  return std::exp2(extent_stops * T(-0.5));
}

/// Weighted RMS of the blur errors of the used targets, computed without overflow; 0 if no target is used.
inline double rms_error(std::span<const FocusTarget> targets, std::span<const TargetBlur> blurs) noexcept {
  const auto error = [&](std::size_t i) {
    return blurs[i].status == TargetStatus::used ? blurs[i].blur_mm - blurs[i].target_mm : 0;
  };
  const auto weight = [&](std::size_t i) { return blurs[i].status == TargetStatus::used ? targets[i].weight : 0; };
  double largest = 0, most = 0;
  for (std::size_t i = 0; i < blurs.size(); ++i) {
    largest = std::fmax(largest, std::abs(error(i)));
    most = std::fmax(most, weight(i));
  }
  if (!(largest > 0 && most > 0)) return 0;
  if (std::isinf(largest)) return largest;
  double squares = 0, total = 0;
  for (std::size_t i = 0; i < blurs.size(); ++i) {
    const double relative_error = error(i) / largest, relative_weight = weight(i) / most;
    squares += relative_weight * relative_error * relative_error;
    total += relative_weight;
  }
  return largest * std::sqrt(squares / total);
}

}  // namespace petzval::focus_detail
