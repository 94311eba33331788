// SPDX-License-Identifier: Apache-2.0
#include "conjugates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace petzval::focus_detail {
namespace {

using enum FocusStatus;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();

/// The p of a subject at the front of the lens.
double least_p(const Conjugates& c) noexcept { return std::max(0.0, c.lens.front_focal_z); }

/// The largest p with a real image. Infinite unless the lens focuses distant subjects inside itself.
double farthest_p(const Conjugates& c) noexcept {
  const bool real_at_infinity = (c.lens.rear_focal_z - c.lens.rear_z) * c.direction >= 0;
  return real_at_infinity ? infinity : c.lens.product() / (c.lens.rear_z - c.lens.rear_focal_z);
}

double distance_at(const Conjugates& c, double p) noexcept {
  return c.origin == DistanceOrigin::film ? (c.lens.rear_focal_z - c.lens.front_focal_z) + (p + c.lens.product() / p)
                                          : p + c.focal_distance;
}

double p_at(const Conjugates& c, double distance) noexcept {
  return c.origin == DistanceOrigin::film ? c.lens.object_at_separation(distance) : distance - c.focal_distance;
}

FocusSolution pair(const Conjugates& c, FocusStatus status, double p) noexcept {
  return {status, c.film_z(p), c.subject_z(p), distance_at(c, p)};
}

}  // namespace

bool Conjugates::real(double film) const noexcept {
  return std::isfinite(film) && (film - lens.rear_z) * direction > 0;
}

double Conjugates::vergence_of_film(double film) const noexcept {
  return 1 / (lens.product() / (film - lens.rear_focal_z) + (near_z - lens.front_focal_z));
}

Conjugates::Conjugates(const IdealLens& thick, FocusCriterion criterion, DistanceOrigin from, double pupil_z) noexcept
    : lens(criterion == FocusCriterion::thin ? thin_lens(thick) : thick),
      direction(lens.product() > 0 ? 1 : -1),
      origin(from),
      focal_distance(-lens.front_focal_z),
      near_z(std::abs(lens.front_focal_length) + std::max(0.0, lens.front_focal_z)) {
  if (origin == DistanceOrigin::entrance_pupil) {
    origin_z = pupil_z;
    focal_distance = pupil_z - lens.front_focal_z;
  } else if (origin == DistanceOrigin::front_principal) {
    origin_z = thick.front_principal_z();
    // A focal length is free of the rounding error that the difference of two positions would have.
    focal_distance = criterion == FocusCriterion::thin ? origin_z - lens.front_focal_z : lens.front_focal_length;
  }
}

double nearest_p(const Conjugates& c) noexcept {
  const bool turns = c.origin == DistanceOrigin::film && c.lens.product() > 0;
  return turns ? std::max(least_p(c), std::sqrt(c.lens.product())) : least_p(c);
}

FocusSolution no_focus(const Conjugates& c) noexcept {
  return {unreachable, c.direction * infinity, -infinity, infinity};
}

FocusSolution paraxial_focus(const Conjugates& c, double distance) noexcept {
  const double near = nearest_p(c), far = farthest_p(c);
  if (!(near < far)) return no_focus(c);
  const double p = p_at(c, distance);
  if (!(p > 0) || distance < distance_at(c, near) * (1 - rounding)) return pair(c, unreachable, near);
  if (distance > distance_at(c, far) * (1 + rounding)) return pair(c, unreachable, far);
  FocusSolution result = pair(c, solved, p);
  result.distance = distance;  // exactly as given
  if (c.origin != DistanceOrigin::film) result.subject_z = c.origin_z - distance;
  return result;
}

FocusSolution paraxial_subject(const Conjugates& c, double film_z) noexcept {
  const double near = least_p(c), far = farthest_p(c);
  if (!(near < far)) return no_focus(c);
  const double extension = film_z - c.lens.rear_focal_z;
  const double p = extension == 0 ? infinity : c.lens.product() / extension;
  if (!(p > 0) || p > far * (1 + rounding)) return pair(c, unreachable, far);
  if (p < near * (1 - rounding)) return pair(c, unreachable, near);
  return {solved, film_z, c.subject_z(p),
          c.origin == DistanceOrigin::film ? film_z - c.subject_z(p) : distance_at(c, p)};
}

FocusSolution paraxial_nearest(const Conjugates& c) noexcept {
  // Behind a mirror, film and subject can coincide.
  const bool meets = c.origin == DistanceOrigin::film && c.lens.product() < 0;
  const double near = meets ? p_at(c, 0) : nearest_p(c);
  return near < farthest_p(c) ? pair(c, solved, near) : no_focus(c);
}

}  // namespace petzval::focus_detail
