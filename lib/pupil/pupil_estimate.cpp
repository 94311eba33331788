// SPDX-License-Identifier: Apache-2.0
#include "pupil_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace petzval::pupil_detail {

bool recentre(PupilEstimate& found, std::span<const Vec2<double>> units) {
  if (found.empty()) return false;
  std::vector<Vec2<double>> rim;  // in units of the half axes
  Vec2<double> low{0, 0}, high{0, 0};
  const std::size_t directions = units.size();
  for (std::size_t k = 0; k < directions; ++k) {
    const auto& [obscured_from, obscured_to, to, slope] = found.ends[k];
    if (obscured_to > 0 || !(to > 0)) return false;
    rim.push_back(to * units[k]);
    for (int i : {0, 1}) low[i] = std::min(low[i], rim[k][i]), high[i] = std::max(high[i], rim[k][i]);
  }
  constexpr double max_middle_offset = 0.05;
  const Vec2<double> middle = (low + high) / 2.0, half = (high - low) / 2.0;
  if (std::abs(middle.x) < max_middle_offset * half.x && std::abs(middle.y) < max_middle_offset * half.y) return false;
  PupilEstimate result{found.middle + found.half_axes * middle, found.half_axes * half, {}, {}};
  for (auto& p : rim) p = (p - middle) / half;
  const auto turn = [](const Vec2<double>& a, const Vec2<double>& b) { return a.y * b.x - a.x * b.y; };
  for (const Vec2<double>& unit : units) {
    for (std::size_t k = 0; k < directions; ++k) {
      const Vec2<double>&a = rim[k], &b = rim[(k + 1) % directions];
      if (!(turn(a, unit) >= 0 && turn(unit, b) > 0)) continue;
      result.ends.push_back({0, 0, turn(a, b) / (turn(a, unit) + turn(unit, b)), 0});
      break;
    }
  }
  if (result.ends.size() != directions) return false;
  found = result;
  return true;
}

PupilRegion region_of(const PupilEstimate& found, std::span<const Vec2<double>> units) {
  const std::size_t directions = units.size();
  PupilRegion region{.middle = found.middle, .half_axes = found.half_axes, .directions = directions};
  if (found.empty()) return region;
  region.spans.reserve(directions);
  for (std::size_t k = 0; k < directions; ++k) {
    const auto& [obscured_from, obscured_to, to, slope] = found.ends[k];
    if (!(to > 0)) continue;
    const auto rim = [&, x = units[k][0], y = units[k][1]](double radius) -> RimPoint {
      return {region.middle[0] + region.half_axes[0] * radius * x, region.middle[1] + region.half_axes[1] * radius * y};
    };
    const auto add = [&](double begin, double end) { region.spans.push_back({k, begin, end, rim(begin), rim(end)}); };
    std::vector<Gap> gaps = found.gaps.empty() ? std::vector<Gap>{} : found.gaps[k];
    if (obscured_from < obscured_to) gaps.push_back({obscured_from, obscured_to});
    std::sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.from < b.from; });
    double begin = 0;
    for (const Gap& gap : gaps) {
      if (gap.from > begin) add(begin, gap.from);
      begin = gap.to;
    }
    add(begin, to);
  }
  return region;
}

}  // namespace petzval::pupil_detail
