// SPDX-License-Identifier: Apache-2.0
#include "petzval/pupil/pupil_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace petzval {
namespace {

/// What passes along one direction, its gaps filled.
struct Extent {
  double from = 0, to = 0;
  bool any = false;
};

std::vector<Extent> extents(const PupilOutline& outline) {
  std::vector<Extent> result(outline.directions);
  for (const PupilSpan& span : outline.spans) {
    Extent& e = result[span.direction];
    e.from = e.any ? std::min(e.from, span.from_radius) : span.from_radius;
    e.to = e.any ? std::max(e.to, span.to_radius) : span.to_radius;
    e.any = true;
  }
  return result;
}

}  // namespace

PupilSampler::PupilSampler(const PupilOutline& outline)
    : plane_(outline.plane), wavelength_(outline.wavelength), middle_(outline.middle), half_axes_(outline.half_axes) {
  if (outline.empty()) return;
  const auto along = extents(outline);
  const std::size_t n = outline.directions;
  turn_ = 2 * std::numbers::pi / static_cast<double>(n);

  // Between two directions an edge may reach past both of them by half of what it gains in a step, at a corner where
  // two rims meet, and by the bulge of an arc.
  constexpr double margin = 0.002;
  double sum = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Extent &a = along[k], &b = along[(k + 1) % n];
    if (!a.any && !b.any) continue;
    double inner_step = 0, outer_step = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Extent &p = along[(k + n - 1 + i) % n], &q = along[(k + i) % n];
      if (!p.any || !q.any) continue;
      inner_step = std::max(inner_step, std::abs(p.from - q.from));
      outer_step = std::max(outer_step, std::abs(p.to - q.to));
    }
    const double least = !a.any ? b.from : !b.any ? a.from : std::min(a.from, b.from);
    const double inner = std::max(0.0, least - inner_step / 2 - margin);
    const double outer = std::max(a.to, b.to) + outer_step / 2 + margin;
    sum += (outer - inner) * (outer + inner);
    const double angle = turn_ * (static_cast<double>(k) + 0.5);
    sectors_.push_back({sum, angle, inner * inner, outer * outer});
  }
  for (Sector& s : sectors_) s.until /= sum;
  sectors_.back().until = 1;
  area_ = sum * turn_ / 2 * half_axes_[0] * half_axes_[1];
}

std::array<double, 2> PupilSampler::operator()(double u, double v) const noexcept {
  const auto after = [](double share, const Sector& s) { return share < s.until; };
  auto sector = std::upper_bound(sectors_.begin(), sectors_.end(), u, after);
  if (sector == sectors_.end()) --sector;
  const double before = sector == sectors_.begin() ? 0 : std::prev(sector)->until;
  const double angle = sector->angle + turn_ * ((u - before) / (sector->until - before));
  const double radius = std::sqrt(sector->inner_squared + v * (sector->outer_squared - sector->inner_squared));
  return {middle_[0] + half_axes_[0] * radius * std::sin(angle), middle_[1] + half_axes_[1] * radius * std::cos(angle)};
}

}  // namespace petzval
