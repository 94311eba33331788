// SPDX-License-Identifier: Apache-2.0
#include "petzval/focus/autofocus.hpp"

#include <cmath>
#include <limits>

#include "core/text.hpp"
#include "petzval/core/error.hpp"
#include "targets.hpp"

namespace petzval {

std::string_view name(TargetStatus status) noexcept {
  switch (status) {
    case TargetStatus::used: return "used";
    case TargetStatus::no_weight: return "no_weight";
    case TargetStatus::not_finite: return "not_finite";
    case TargetStatus::no_image: return "no_image";
    case TargetStatus::outlier: return "outlier";
    case TargetStatus::no_rays: return "no_rays";
  }
  return "unknown";
}

std::string_view name(PlaneRank rank) noexcept {
  switch (rank) {
    case PlaneRank::none: return "none";
    case PlaneRank::point: return "point";
    case PlaneRank::line: return "line";
    case PlaneRank::plane: return "plane";
  }
  return "unknown";
}

void focus_detail::check_extent(double stops, const std::string& where) {
  if (std::abs(stops) <= largest_extent) return;
  throw Error(where + "extent = " + to_text(stops) + " stops; must be " + to_text(-largest_extent) + " to " +
              to_text(largest_extent) + " stops");
}

bool focus_detail::well_formed(const FocusTarget& target) noexcept {
  const Vec3<double>& p = target.point.position;
  const bool valid_position = std::isfinite(p.x) && std::isfinite(p.y) && p.z < std::numeric_limits<double>::infinity();
  return valid_position && std::isfinite(target.blur_mm) && std::isfinite(target.weight) && target.weight >= 0;
}

}  // namespace petzval
