// SPDX-License-Identifier: Apache-2.0
#include "pupil/pupil_boundary.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "pupil_region.hpp"

namespace petzval {

PupilSampler::PupilSampler(const PupilBoundary& boundary)
    : plane_(boundary.plane),
      wavelength_(boundary.wavelength),
      middle_(boundary.middle),
      half_axes_(boundary.half_axes) {
  if (boundary.empty()) return;
  using pupil_detail::Extent;
  const std::vector<Extent> along = pupil_detail::extents(boundary);
  const std::size_t n = boundary.directions;
  // Pieces are so slim that a few terms of the series of sine and cosine suffice.
  constexpr std::size_t least_pieces = 64;
  const std::size_t subdivisions = (least_pieces + n - 1) / n;
  const double turn = 2 * std::numbers::pi / static_cast<double>(n * subdivisions);
  half_turn_ = turn / 2;

  // Between two directions an edge may lie outside both: at a corner where two rims meet, by half of the change per
  // direction; on an arc, by the sagitta of the chord.
  constexpr double margin = 0.002;
  double sum = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Extent &a = along[k], &b = along[(k + 1) % n];
    if (!a.lit && !b.lit) continue;
    double inner_step = 0, outer_step = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Extent &p = along[(k + n - 1 + i) % n], &q = along[(k + i) % n];
      if (!p.lit || !q.lit) continue;
      inner_step = std::max(inner_step, std::abs(p.from() - q.from()));
      outer_step = std::max(outer_step, std::abs(p.to - q.to));
    }
    const double least = !a.lit ? b.from() : !b.lit ? a.from() : std::min(a.from(), b.from());
    const double inner = std::max(0.0, least - inner_step / 2 - margin);
    const double outer = std::max(a.to, b.to) + outer_step / 2 + margin;
    const double squares = (outer - inner) * (outer + inner);
    for (std::size_t subdivision = 0; subdivision < subdivisions; ++subdivision) {
      const double angle = half_turn_ * static_cast<double>((2 * k + 1) * subdivisions + 2 * subdivision + 1);
      pieces_.push_back({sum, squares, std::sin(angle), std::cos(angle), inner * inner, squares});
      until_.push_back(sum += squares);
    }
  }
  area_ = sum * half_turn_ * half_axes_[0] * half_axes_[1];
  for (Piece& p : pieces_) p.before /= sum, p.angle_per_fraction = turn / (p.angle_per_fraction / sum);
  for (double& area_fraction : until_) area_fraction /= sum;
  until_.back() = std::numeric_limits<double>::infinity();  // guards against rounding

  // With four steps per piece, few steps contain the ends of several pieces.
  first_.resize(4 * std::bit_ceil(pieces_.size()));
  const double step = 1 / static_cast<double>(first_.size());
  for (std::size_t i = 0, piece = 0; i < first_.size(); ++i) {
    while (until_[piece] <= step * static_cast<double>(i)) ++piece;
    first_[i] = static_cast<std::uint32_t>(piece);
  }
}

Vec2<double> PupilSampler::operator()(double u, double v) const noexcept {
  Vec2<double> point{u, v};
  const std::span x(&point[0], 1), y(&point[1], 1);
  (*this)(x, y, x, y);
  return point;
}

void PupilSampler::operator()(std::span<const double> u, std::span<const double> v, std::span<double> x,
                              std::span<double> y) const noexcept {
  constexpr std::size_t block = 64;
  const std::size_t points = std::min({u.size(), v.size(), x.size(), y.size()});
  const auto steps = static_cast<double>(first_.size());
  const std::size_t last = first_.size() - 1;
  for (std::size_t begin = 0; begin < points; begin += block) {
    const std::size_t count = std::min(block, points - begin);
    // The first comparison is branch-free, because a branch would be mispredicted half of the time.
    std::array<std::uint32_t, block> at;
    std::array<double, block> across, up;
    for (std::size_t i = 0; i < count; ++i) {
      const double area_fraction = u[begin + i];
      std::uint32_t piece = first_[std::min(static_cast<std::size_t>(area_fraction * steps), last)];
      piece += until_[piece] <= area_fraction;
      while (until_[piece] <= area_fraction) ++piece;
      at[i] = piece;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Piece& p = pieces_[at[i]];
      const double a = (u[begin + i] - p.before) * p.angle_per_fraction - half_turn_, aa = a * a;
      const double sine = a * (1 + aa * (-1.0 / 6 + aa * (1.0 / 120 + aa * (-1.0 / 5040))));
      const double cosine = 1 + aa * (-0.5 + aa * (1.0 / 24 + aa * (-1.0 / 720 + aa * (1.0 / 40320))));
      const double radius = std::sqrt(p.inner_squared + v[begin + i] * p.outer_less_inner);
      across[i] = middle_[0] + half_axes_[0] * radius * (p.sine * cosine + p.cosine * sine);
      up[i] = middle_[1] + half_axes_[1] * radius * (p.cosine * cosine - p.sine * sine);
    }
    std::copy_n(across.begin(), count, x.begin() + begin);
    std::copy_n(up.begin(), count, y.begin() + begin);
  }
}

}  // namespace petzval
