// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <vector>

#include "pupil_region.hpp"

namespace petzval {

Vec2<double> PupilRegion::unit(std::size_t direction) const noexcept {
  const double angle = 2 * std::numbers::pi * (static_cast<double>(direction) + 0.5) / static_cast<double>(directions);
  return {std::sin(angle), std::cos(angle)};
}

Vec2<double> PupilRegion::at(std::size_t direction, double radius) const noexcept {
  return middle + half_axes * radius * unit(direction);
}

double PupilRegion::area() const noexcept {
  double sum = 0;
  for (const PupilSpan& s : spans) sum += (s.to_radius - s.from_radius) * (s.to_radius + s.from_radius);
  return directions == 0 ? 0 : pupil_detail::area_of(*this, sum);
}

namespace pupil_detail {

double area_of(const PupilRegion& region, double squared_radii) noexcept {
  return squared_radii * std::numbers::pi / static_cast<double>(region.directions) * region.half_axes.x *
         region.half_axes.y;
}

std::vector<Extent> extents(const PupilRegion& region) {
  std::vector<Extent> result(region.directions);
  for (const PupilSpan& span : region.spans) {
    Extent& e = result[span.direction];
    if (!e.lit) {
      e.obscured_to = span.from_radius;
    } else if (e.obscured_from > 0 || e.obscured_to == 0) {  // rays pass at the middle
      if (span.from_radius - e.to > e.obscured_to - e.obscured_from) {
        e.obscured_from = e.to, e.obscured_to = span.from_radius;
      }
    }
    e.to = span.to_radius, e.rim = span.to, e.lit = true;
  }
  return result;
}

void keep_connected(PupilRegion& region, const Vec2<double>& position) {
  const std::vector<PupilSpan>& spans = region.spans;
  if (spans.empty()) return;
  const Vec2<double> half{std::max(region.half_axes.x, 1e-300), std::max(region.half_axes.y, 1e-300)};
  const Vec2<double> at = (position - region.middle) / half;
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const Vec2<double> unit = region.unit(spans[i].direction);
    const double along = std::clamp(glm::dot(at, unit), spans[i].from_radius, spans[i].to_radius);
    const double distance = glm::length(at - unit * along);
    if (distance < least) least = distance, nearest = i;
  }

  std::vector<std::size_t> first(region.directions + 1, 0);  // index of the first span of each direction
  for (const PupilSpan& span : spans) ++first[span.direction + 1];
  for (std::size_t k = 0; k < region.directions; ++k) first[k + 1] += first[k];
  std::vector<bool> kept(spans.size(), false);
  std::vector<std::size_t> open{nearest};
  kept[nearest] = true;
  bool middle = false;  // true if the spans that begin at the middle were taken
  const auto take = [&](std::size_t i) {
    if (!kept[i]) kept[i] = true, open.push_back(i);
  };
  // Between two directions, the ends of the tip of a crescent may move by more than its width.
  const double steep = region.directions == 1 ? 0 : 0.1;
  while (!open.empty()) {
    const PupilSpan span = spans[open.back()];
    open.pop_back();
    for (const std::size_t adjacent :
         {(span.direction + 1) % region.directions, (span.direction + region.directions - 1) % region.directions}) {
      for (std::size_t i = first[adjacent]; i < first[adjacent + 1]; ++i) {
        const double gap = std::max(spans[i].from_radius - span.to_radius, span.from_radius - spans[i].to_radius);
        if (gap <= steep * span.to_radius) take(i);
      }
    }
    if (span.from_radius > 0 || middle) continue;
    middle = true;
    for (std::size_t i = 0; i < spans.size(); ++i) {
      if (spans[i].from_radius == 0) take(i);
    }
  }
  std::vector<PupilSpan> connected;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    if (kept[i]) connected.push_back(spans[i]);
  }
  region.spans = std::move(connected);
}

void keep_within(PupilRegion& region, const PupilRegion& other) {
  auto span = other.spans.begin();
  std::erase_if(region.spans, [&](const PupilSpan& candidate) {
    while (span != other.spans.end() &&
           (span->direction < candidate.direction ||
            (span->direction == candidate.direction && span->to_radius < candidate.from_radius))) {
      ++span;
    }
    return span == other.spans.end() || span->direction != candidate.direction ||
           span->from_radius > candidate.to_radius;
  });
}

}  // namespace pupil_detail
}  // namespace petzval
