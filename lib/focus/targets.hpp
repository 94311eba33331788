// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "petzval/core/export.hpp"
#include "petzval/focus/focus_point.hpp"

namespace petzval::focus_detail {

/// Whether a target has no NaN, nothing infinite except z = -inf, and no negative weight.
PETZVAL_API bool well_formed(const FocusTarget& target) noexcept;

/// Extents of the depth of field are within so many stops.
inline constexpr double largest_extent = 20;
/// Throws Error, which begins with `where`, for an extent that is not.
void check_extent(double stops, const std::string& where);

/// Throws what focus_targets() throws.
void check_points(std::span<const FocusPoint> points, const FocusMoment& moment);
/// A checked point as target at a moment, valid then or not. Nothing without an image, and beside the moment's film.
std::optional<FocusTarget> target_at(const IdealLens& lens, const FocusPoint& point, const FocusMoment& moment);
/// FocusMoment::nearer_weighs_more.
void weigh_nearer_more(const IdealLens& lens, std::span<FocusTarget> targets);

/// In focal lengths from the rear focal point: no film is farther away, and images that are belong to points in the
/// front focal plane or far beside the lens.
inline constexpr double farthest_film = 1e9;

/// How large the pupil is for an extent of the depth of field in stops, over that for 0.
template <class T>
T pupil_scale(T extent_stops) noexcept {
  return std::exp2(extent_stops * T(-0.5));
}

/// The weighted RMS of the blur minus the wanted blur over the targets used, without overflow; 0 if there are none.
inline double rms_error(std::span<const FocusTarget> targets, std::span<const TargetBlur> blurs) noexcept {
  const auto error = [&](std::size_t i) {
    return blurs[i].use == TargetUse::used ? blurs[i].blur_mm - blurs[i].wanted_mm : 0;
  };
  const auto weight = [&](std::size_t i) { return blurs[i].use == TargetUse::used ? targets[i].weight : 0; };
  double largest = 0, most = 0;
  for (std::size_t i = 0; i < blurs.size(); ++i) {
    largest = std::fmax(largest, std::abs(error(i)));
    most = std::fmax(most, weight(i));
  }
  if (!(largest > 0 && most > 0)) return 0;
  if (std::isinf(largest)) return largest;
  double squares = 0, total = 0;
  for (std::size_t i = 0; i < blurs.size(); ++i) {
    const double part = error(i) / largest, share = weight(i) / most;
    squares += share * part * part;
    total += share;
  }
  return largest * std::sqrt(squares / total);
}

}  // namespace petzval::focus_detail
