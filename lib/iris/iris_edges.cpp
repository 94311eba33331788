// SPDX-License-Identifier: Apache-2.0
#include "iris_edges.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/text.hpp"
#include "petzval/core/error.hpp"

namespace petzval {
namespace iris_detail {
namespace {

constexpr double pi = std::numbers::pi;

/// (angle - sin(angle)) / angle^3, accurate for small angles.
double excess(double angle) noexcept {
  if (std::abs(angle) > 0.3) return (angle - std::sin(angle)) / (angle * angle * angle);
  const double square = angle * angle;
  return (1 - square / 20 * (1 - square / 42 * (1 - square / 72 * (1 - square / 110 * (1 - square / 156))))) / 6;
}

}  // namespace

void check(const Iris& iris, const std::string& where) {
  const auto& [blades, roundness, rotation_rad] = iris;
  if (!(blades == 0 || (blades >= 3 && blades <= 20))) {
    throw Error(where + "blades = " + std::to_string(blades) + "; must be 3 to 20, or 0 for a round iris");
  }
  if (!(roundness >= -1 && roundness <= 1)) {
    throw Error(where + "roundness = " + to_text(roundness) + "; must be -1 to 1");
  }
  constexpr double farthest = 1e6;  // larger angles lose too many digits within a turn
  if (!(std::abs(rotation_rad) <= farthest)) {
    throw Error(where + "rotation_rad = " + to_text(rotation_rad) + "; absolute value must be at most " +
                to_text(farthest));
  }
}

Blade::Blade(const Iris& iris) : half_angle(pi / iris.blades), half_chord(std::sin(half_angle)) {
  // If edges are bent inwards, corners keep at least half of the angle of the straight polygon.
  const double most = iris.roundness < 0 ? std::min(half_angle, (pi / 2 - half_angle) / 2) : half_angle;
  const double at_corner = iris.roundness * most;
  curvature = std::sin(at_corner) / half_chord;
  middle = std::cos(half_angle) + half_chord * std::tan(at_corner / 2);
}

// The sum of a triangle to the middle of the edge and the area between the edge and its tangent at the middle.
double Blade::twice_area(double across) const noexcept {
  const double angle = std::asin(std::clamp(curvature * across, -1.0, 1.0));
  const double per_curvature = curvature == 0 ? across : angle / curvature;
  return middle * across + per_curvature * per_curvature * angle * excess(angle);
}

// Newton's method from the side on which it does not overshoot: if the edge is bent outwards, the area grows faster and
// faster.
double Blade::across_at(double edge_fraction) const noexcept {
  const double target_area = edge_fraction * twice_area(half_chord);
  double across = curvature > 0 ? half_chord : 0;
  for (int i = 0; i < 50; ++i) {
    const double cosine = std::sqrt(1 - curvature * across * curvature * across);
    const double rate = middle + curvature * across * across / ((1 + cosine) * cosine);
    const double step = (target_area - twice_area(across)) / rate;
    across = std::clamp(across + step, 0.0, half_chord);
    if (std::abs(step) <= 1e-16) break;
  }
  return across;
}

double Blade::along_at(double across) const noexcept {
  return middle - curvature * across * across / (1 + std::sqrt(1 - curvature * across * curvature * across));
}

std::vector<IrisEdge> edges(const Iris& iris) {
  std::vector<IrisEdge> result;
  if (iris.round()) return result;
  const Blade blade(iris);
  // From |p - c|^2 <= 1 / curvature^2, times curvature / 2; c lies 1 / curvature below the middle.
  const double slope = 1 - blade.curvature * blade.middle;
  for (int k = 0; k < iris.blades; ++k) {
    const double angle = (2 * k + 1) * blade.half_angle - iris.rotation_rad;
    result.push_back({slope * std::sin(angle), slope * std::cos(angle), blade.curvature / 2,
                      blade.middle * (1 - blade.curvature * blade.middle / 2)});
  }
  return result;
}

Iris upside_down(Iris iris, bool along_x, bool along_y) {
  iris.rotation_rad = std::remainder(iris.rotation_rad, 2 * pi);
  // A regular polygon is symmetric about the line through a corner.
  if (along_x) iris.rotation_rad = -iris.rotation_rad;
  if (along_y) iris.rotation_rad = pi - iris.rotation_rad;
  return iris;
}

}  // namespace iris_detail

double iris_area(const Iris& iris) {
  iris_detail::check(iris, "iris: ");
  if (iris.round()) return std::numbers::pi;
  const iris_detail::Blade blade(iris);
  return iris.blades * blade.twice_area(blade.half_chord);
}

double equal_area_f_number(const Iris& iris, double f_number) {
  if (!(f_number > 0 && std::isfinite(f_number))) {
    throw Error("iris: f_number = " + to_text(f_number) + "; must be finite and above 0");
  }
  return f_number * std::sqrt(iris_area(iris) / std::numbers::pi);
}

}  // namespace petzval
