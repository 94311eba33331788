// SPDX-License-Identifier: Apache-2.0
#include "image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/bisect.hpp"

namespace petzval::inline v0::focus_detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double square(double x) { return x * x; }

}  // namespace

double Image::diameter(double film) const noexcept {
  if (lines.empty()) return std::hypot(least, slope * (film - film_z));
  double largest = 0;
  for (const Line& line : lines) {
    const double shift = film - plane_z;
    largest = std::max(largest, square(line.x + shift * line.slope_x) + square(line.y + shift * line.slope_y));
  }
  return 2 * std::sqrt(largest);
}

/// The mean square radius is a parabola over the position of the film, with its vertex at -cov(p, u) / var(u), p the
/// point in the plane and u the slope.
Image least_rms(std::span<const Line> lines, double plane_z) {
  double covariance = 0, variance = 0, least = 0;
  for (const Line& line : lines) {
    covariance += line.weight * (line.x * line.slope_x + line.y * line.slope_y);
    variance += line.weight * (square(line.slope_x) + square(line.slope_y));
  }
  const double shift = variance == 0 ? infinity : -covariance / variance;
  for (const Line& line : lines) {
    least += line.weight * (square(line.x + shift * line.slope_x) + square(line.y + shift * line.slope_y));
  }
  // The RMS radius of a uniform disc is its diameter over the root of 8.
  return {.film_z = plane_z + shift,
          .plane_z = plane_z,
          .least = std::sqrt(8 * least),
          .slope = std::sqrt(8 * variance),
          .lines = {}};
}

/// The largest of the squared radii, each a parabola over the position of the film, is convex: it falls where the
/// parabola that is largest there falls.
Image least_maximum(std::vector<Line> lines, double plane_z) {
  const auto rises = [&](double shift) {
    double largest = -1, slope = 0;
    for (const Line& line : lines) {
      const double x = line.x + shift * line.slope_x, y = line.y + shift * line.slope_y;
      const double radius2 = square(x) + square(y);
      if (radius2 > largest) largest = radius2, slope = x * line.slope_x + y * line.slope_y;
    }
    return slope > 0;
  };
  double low = infinity, high = -infinity;
  for (const Line& line : lines) {
    const double steepness = square(line.slope_x) + square(line.slope_y);
    if (steepness == 0) continue;
    const double vertex = -(line.x * line.slope_x + line.y * line.slope_y) / steepness;
    low = std::min(low, vertex), high = std::max(high, vertex);
  }
  double shift = low;
  if (low < high) shift = rises(low) ? low : core_detail::last_with(low, high, [&](double z) { return !rises(z); });
  return {.film_z = plane_z + shift, .plane_z = plane_z, .lines = std::move(lines)};
}

}  // namespace petzval::inline v0::focus_detail
