// SPDX-License-Identifier: Apache-2.0
#include "plane_fit.hpp"

#include <algorithm>
#include <cmath>

namespace petzval::focus_detail {

PicturePoint picture_point(const ScenePoint& scene_point, double z) noexcept {
  const auto& [p, at_infinity] = scene_point;
  if (std::isinf(p.z)) return {};
  const double depth = (at_infinity ? 0 : z) - p.z;
  return {p.x / depth, p.y / depth, at_infinity ? 0 : 1 / depth};
}

PlaneFit fit_plane(std::span<const PicturePoint> points) {
  PlaneFit fit;
  double largest = 0;
  for (const auto& p : points) largest = std::max(largest, p.weight);
  if (!(largest > 0)) return fit;
  double total = 0;
  for (const auto& p : points) {
    const double w = p.weight / largest;
    total += w;
    fit.mean_x += w * p.x, fit.mean_y += w * p.y, fit.c += w * p.inverse_distance;
  }
  fit.mean_x /= total, fit.mean_y /= total, fit.c /= total;

  // Moments about the centroid: xx, xy, yy of the positions; xd, yd of positions and inverse distance.
  double xx = 0, xy = 0, yy = 0, xd = 0, yd = 0;
  for (const auto& p : points) {
    const double w = p.weight / largest, x = p.x - fit.mean_x, y = p.y - fit.mean_y, d = p.inverse_distance - fit.c;
    xx += w * x * x, xy += w * x * y, yy += w * y * y;
    xd += w * x * d, yd += w * y * d;
  }
  // Main direction in the picture, and the spread of the points along and across.
  const double turn = std::atan2(2 * xy, xx - yy) / 2;
  fit.along_x = std::cos(turn), fit.along_y = std::sin(turn);
  const double ax = fit.along_x, ay = fit.along_y;
  const double along = ax * ax * xx + 2 * ax * ay * xy + ay * ay * yy;
  const double across = ay * ay * xx - 2 * ax * ay * xy + ax * ax * yy;
  fit.spread = std::sqrt(std::max(along, 0.0) / total);
  if (!(fit.spread > coincidence_spread)) {
    fit.rank = PlaneRank::point;
    return fit;
  }
  fit.aspect = std::sqrt(std::max(across, 0.0) / along);
  if (!(fit.aspect > line_aspect)) {
    fit.rank = PlaneRank::line;
    const double slope = (ax * xd + ay * yd) / along;
    fit.a = slope * ax, fit.b = slope * ay;
  } else {
    fit.rank = PlaneRank::plane;
    // The slopes along both main directions are independent, because the mixed moment is 0.
    const double first = (ax * xd + ay * yd) / along, second = (ax * yd - ay * xd) / across;
    fit.a = first * ax - second * ay, fit.b = first * ay + second * ax;
  }
  fit.c -= fit.a * fit.mean_x + fit.b * fit.mean_y;
  return fit;
}

std::optional<Plane> plane_of(const PlaneFit& fit, double z) {
  // a x + b y + c (z - p.z) = 1
  const double length = std::hypot(fit.a, fit.b, fit.c) * (fit.c > 0 ? -1 : 1);
  const Plane plane{{fit.a / length, fit.b / length, -fit.c / length}, (1 - fit.c * z) / length};
  if (length == 0 || !std::isfinite(plane.offset)) return {};
  return plane;
}

}  // namespace petzval::focus_detail
