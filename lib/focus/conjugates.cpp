// SPDX-License-Identifier: Apache-2.0
#include "conjugates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace petzval::inline v0::focus_detail {
namespace {

using enum FocusStatus;
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

/// The subject in front of the lens.
double least_p(const Conjugates& c) noexcept { return std::max(0.0, c.front_focal_z); }

/// The largest p with a real image: infinite, unless the lens brings a distant subject to focus inside itself.
double farthest_p(const Conjugates& c) noexcept {
  const bool real_at_infinity = (c.rear_focal_z - c.last_z) * c.sense >= 0;
  return real_at_infinity ? infinity : c.product / (c.last_z - c.rear_focal_z);
}

double distance_at(const Conjugates& c, double p) noexcept {
  return c.origin == DistanceOrigin::film ? (c.rear_focal_z - c.front_focal_z) + (p + c.product / p)
                                          : p + c.focal_distance;
}

double p_at(const Conjugates& c, double distance) noexcept {
  return c.origin == DistanceOrigin::film ? far_root(c.product, distance - (c.rear_focal_z - c.front_focal_z))
                                          : distance - c.focal_distance;
}

FocusSolution pair(const Conjugates& c, FocusStatus status, double p) noexcept {
  return {status, c.film_z(p), c.subject_z(p), distance_at(c, p)};
}

}  // namespace

bool Conjugates::real(double film) const noexcept { return std::isfinite(film) && (film - last_z) * sense > 0; }

double Conjugates::nearness_of_film(double film) const noexcept {
  return 1 / (product / (film - rear_focal_z) + (near_z - front_focal_z));
}

Conjugates conjugates(const Lens& lens, const FirstOrder& data, FocusCriterion criterion, DistanceOrigin origin) {
  const double f = data.effective_focal_length;
  const bool thin = criterion == FocusCriterion::thin;
  const double focal_z = thin ? data.rear_principal_z - data.object_index * f : data.front_focal_z;
  Conjugates c{.front_focal_z = focal_z,
               .rear_focal_z = data.rear_focal_z,
               .product = data.object_index * data.image_index * f * f,
               .last_z = lens.surfaces().back().vertex_z,
               .sense = data.image_index > 0 ? 1.0 : -1.0,
               .origin = origin,
               .origin_z = 0,
               .focal_distance = -focal_z,
               .near_z = std::abs(f) + std::max(0.0, focal_z)};
  if (origin == DistanceOrigin::front_principal) {
    c.origin_z = data.front_principal_z;
    // The thick lens's own is a focal length, whatever is lost in the difference of the two places.
    c.focal_distance = thin ? c.origin_z - focal_z : data.object_index * f;
  }
  return c;
}

double nearest_p(const Conjugates& c) noexcept {
  const bool turns = c.origin == DistanceOrigin::film && c.product > 0;
  return turns ? std::max(least_p(c), std::sqrt(c.product)) : least_p(c);
}

FocusSolution no_focus(const Conjugates& c) noexcept { return {unreachable, c.sense * infinity, -infinity, infinity}; }

FocusSolution paraxial_focus(const Conjugates& c, double distance) noexcept {
  const double near = nearest_p(c), far = farthest_p(c);
  if (!(near < far)) return no_focus(c);
  const double p = p_at(c, distance);
  if (!(p > 0) || distance < distance_at(c, near) * (1 - rounding)) return pair(c, unreachable, near);
  if (distance > distance_at(c, far) * (1 + rounding)) return pair(c, unreachable, far);
  FocusSolution result = pair(c, solved, p);
  result.distance = distance;  // to the last bit
  if (c.origin != DistanceOrigin::film) result.subject_z = c.origin_z - distance;
  return result;
}

FocusSolution paraxial_subject(const Conjugates& c, double film_z) noexcept {
  const double near = least_p(c), far = farthest_p(c);
  if (!(near < far)) return no_focus(c);
  const double extension = film_z - c.rear_focal_z;
  const double p = extension == 0 ? infinity : c.product / extension;
  if (!(p > 0) || p > far * (1 + rounding)) return pair(c, unreachable, far);
  if (p < near * (1 - rounding)) return pair(c, unreachable, near);
  return {solved, film_z, c.subject_z(p),
          c.origin == DistanceOrigin::film ? film_z - c.subject_z(p) : distance_at(c, p)};
}

FocusSolution paraxial_nearest(const Conjugates& c) noexcept {
  // Behind a mirror film and subject meet.
  const bool meets = c.origin == DistanceOrigin::film && c.product < 0;
  const double near = meets ? p_at(c, 0) : nearest_p(c);
  return near < farthest_p(c) ? pair(c, solved, near) : no_focus(c);
}

}  // namespace petzval::inline v0::focus_detail
