// SPDX-License-Identifier: Apache-2.0
#include "iris_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/chebyshev.hpp"
#include "iris/iris_edges.hpp"

namespace petzval::iris_detail {
namespace {

constexpr double pi = std::numbers::pi;

/// The fractional part in [0, 1), also of negative numbers.
double fraction(double x) noexcept { return x - std::floor(x); }

}  // namespace

template <class R>
void IrisShape::fill(Columns<R>& columns) const {
  const Blade blade(iris_);
  const auto edge_fraction = [](double t) { return std::sqrt((1 + t) / 2); };
  const auto interpolate = [](const auto& value) {
    return core_detail::by_powers(core_detail::chebyshev_series<edge_terms<R>>(value));
  };
  const auto across = interpolate([&](double t) { return blade.across_at(edge_fraction(t)) / edge_fraction(t); });
  const auto along = interpolate([&](double t) { return blade.along_at(blade.across_at(edge_fraction(t))); });
  columns.across.assign(across.begin(), across.end());
  columns.along.assign(along.begin(), along.end());
  for (int k = 0; k < iris_.blades; ++k) {
    const double angle = (2 * k + 1) * blade.half_angle - iris_.rotation_rad;
    columns.turns.insert(columns.turns.end(), {static_cast<R>(std::sin(angle)), static_cast<R>(std::cos(angle))});
  }
  for (const auto& [nx, ny, bend, distance] : edges(iris_)) {
    columns.edges.insert(columns.edges.end(),
                         {static_cast<R>(nx), static_cast<R>(ny), static_cast<R>(bend), static_cast<R>(distance)});
  }
}

IrisShape::IrisShape(const Iris& iris) : iris_(iris), area_(iris_area(iris)) {
  if (iris.round()) return;
  fill(single_);
  fill(twice_);
}

Vec2<double> IrisShape::sample(double u, double v) const noexcept {
  const auto [x, y] = iris_point(sectors<double>(), u, v);
  return {x, y};
}

Vec2<double> IrisShape::position(double x, double y) const noexcept {
  const double square = x * x + y * y;
  if (!(square > 0)) return {0, 0};
  const double turn = std::atan2(x, y);
  if (round()) return {fraction(turn / (2 * pi)), square};
  const Blade blade(iris_);
  const double sectors = fraction((turn + iris_.rotation_rad) / (2 * pi)) * iris_.blades;
  const double sector = std::min(std::floor(sectors), iris_.blades - 1.0);
  const double angle = (2 * (sectors - sector) - 1) * blade.half_angle;
  // The point at which the line from the centre through the given point meets the edge.
  const double inner_fraction = area_fraction(x, y), to_edge = std::sqrt(square / inner_fraction);
  const double across = std::clamp(to_edge * std::sin(angle), -blade.half_chord, blade.half_chord);
  const double edge_fraction = blade.twice_area(across) / blade.twice_area(blade.half_chord);
  return {(sector + (1 + edge_fraction) / 2) / iris_.blades, inner_fraction};
}

double IrisShape::area_fraction(double x, double y) const noexcept {
  const double square = x * x + y * y;
  const IrisSectors<double> s = sectors<double>();
  if (s.count == 0) return square;
  // The point divided by `edge_fraction` lies on the edge if distance * part^2 - across * part - bend * square = 0.
  double largest = 0;
  for (std::size_t k = 0; k < s.count; ++k) {
    const double* edge = s.edges + 4 * k;
    const double nx = edge[0], ny = edge[1], bend = edge[2], distance = edge[3];
    const double across = x * nx + y * ny, inner = across * across + 4 * distance * bend * square;
    if (inner >= 0) largest = std::max(largest, (across + std::sqrt(inner)) / (2 * distance));
  }
  return largest * largest;
}

bool IrisShape::contains(double x, double y) const noexcept {
  const IrisSectors<double> s = sectors<double>();
  bool within = x * x + y * y <= rim_squared<double>;
  for (std::size_t k = 0; k < s.count; ++k) within = within && within_edge(s, k, x, y);
  return within;
}

}  // namespace petzval::iris_detail
