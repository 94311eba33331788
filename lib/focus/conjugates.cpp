// SPDX-License-Identifier: Apache-2.0
#include "conjugates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace petzval::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();

/// The larger root of p + product / p = sum: the subject at the far conjugate. In factors, so that no square overflows
/// and nothing cancels next to the turning point, where sum is twice the root of the product.
double far_root(double product, double sum) noexcept {
  const double turning = 2 * std::sqrt(std::abs(product));
  const double root =
      product > 0 ? std::sqrt(std::max(0.0, sum - turning)) * std::sqrt(sum + turning) : std::hypot(sum, turning);
  return (sum + root) / 2;
}

/// The largest p with a real image: infinite, unless the lens brings a distant subject to focus inside itself.
double farthest_p(const Conjugates& c) noexcept {
  const bool real_at_infinity = (c.rear_focal_z - c.last_z) * c.sense >= 0;
  return real_at_infinity ? infinity : c.product / (c.last_z - c.rear_focal_z);
}

double distance_at(const Conjugates& c, DistanceOrigin origin, double p) noexcept {
  return origin == DistanceOrigin::film ? (c.rear_focal_z - c.front_focal_z) + (p + c.product / p)
                                        : p - c.front_focal_z;
}

double p_at(const Conjugates& c, DistanceOrigin origin, double distance) noexcept {
  if (origin == DistanceOrigin::front_vertex) return distance + c.front_focal_z;
  return far_root(c.product, distance - (c.rear_focal_z - c.front_focal_z));
}

}  // namespace

Conjugates conjugates(const Lens& lens, const FirstOrder& data, FocusCriterion criterion) {
  const double f = data.effective_focal_length;
  return {.front_focal_z =
              criterion == FocusCriterion::thin ? data.rear_principal_z - data.object_index * f : data.front_focal_z,
          .rear_focal_z = data.rear_focal_z,
          .product = data.object_index * data.image_index * f * f,
          .last_z = lens.surfaces().back().vertex_z,
          .sense = data.image_index > 0 ? 1.0 : -1.0};
}

double nearest_p(const Conjugates& c, DistanceOrigin origin) noexcept {
  const double in_front_of_lens = std::max(0.0, c.front_focal_z);
  return origin == DistanceOrigin::film && c.product > 0 ? std::max(in_front_of_lens, std::sqrt(c.product))
                                                         : in_front_of_lens;
}

FocusSolution solve(const Conjugates& c, double distance, DistanceOrigin origin) {
  const auto solution = [&](FocusSolution::Status status, double p, double nearest) {
    return FocusSolution{status, c.film_z(p), c.subject_z(p), nearest};
  };
  using enum FocusSolution::Status;
  const double near = nearest_p(c, origin), far = farthest_p(c);
  if (!(near < far)) return {unreachable, c.sense * infinity, -infinity, infinity};

  const double p = p_at(c, origin, distance);
  const double nearest = distance_at(c, origin, near), farthest = distance_at(c, origin, far);
  if (!(p > 0) || distance < nearest * (1 - rounding)) return solution(unreachable, near, nearest);
  if (distance > farthest * (1 + rounding)) return solution(unreachable, far, farthest);
  FocusSolution result = solution(solved, p, 0);
  if (origin == DistanceOrigin::front_vertex) result.subject_z = -distance;  // to the last bit
  return result;
}

}  // namespace petzval::detail
