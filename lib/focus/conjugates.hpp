// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::inline v0::focus_detail {

/// Newton's form of the paraxial conjugates: a subject p in front of the front focal point has its image product / p
/// behind the rear one. p is positive for every subject that can be focused.
struct Conjugates {
  double front_focal_z, rear_focal_z;
  double product;  ///< n n' f^2; negative where light leaves backwards
  double last_z;   ///< the film lies behind it, as light runs
  double sense;    ///< +1, or -1 where light leaves backwards
  DistanceOrigin origin;
  double origin_z;        ///< where distances begin; unless that is the film
  double focal_distance;  ///< of the front focal point from there
  double near_z;          ///< behind every subject by a focal length or more: see nearness

  double subject_z(double p) const noexcept { return front_focal_z - p; }
  double film_z(double p) const noexcept { return rear_focal_z + product / p; }
  double distance(double subject_z, double film_z) const noexcept {
    return (origin == DistanceOrigin::film ? film_z : origin_z) - subject_z;
  }
  bool real(double film_z) const noexcept;

  /// Subjects on a scale without a seam at infinity: 0 there, and the reciprocal of the distance to near_z elsewhere.
  double nearness(double subject_z) const noexcept { return 1 / (near_z - subject_z); }
  double subject_at(double nearness) const noexcept { return near_z - 1 / nearness; }
  double nearness_of_vertex() const noexcept { return 1 / near_z; }

  /// Nearness of the subject of which the paraxial image lies on a film: the film on the subject's scale, without a
  /// seam where it goes to infinity (at nearness_of_infinite_film) and comes back from in front of the lens.
  double nearness_of_film(double film_z) const noexcept;
  double nearness_of_infinite_film() const noexcept { return 1 / (near_z - front_focal_z); }
};

/// Of the lens itself, or of the thin lens of its focal length at its rear principal plane (thin).
Conjugates conjugates(const Lens& lens, const FirstOrder& data, FocusCriterion criterion, DistanceOrigin origin);

/// The least p in question: the subject in front of the lens and, where the distance counts from the film, beyond the
/// turning point at which subject and film are as near to each other as they can be.
double nearest_p(const Conjugates& c) noexcept;

/// Where there is no real image of anything.
FocusSolution no_focus(const Conjugates& c) noexcept;

// The paraxial solvers. distance: > 0 or infinite.
FocusSolution paraxial_focus(const Conjugates& c, double distance) noexcept;
FocusSolution paraxial_subject(const Conjugates& c, double film_z) noexcept;
FocusSolution paraxial_nearest(const Conjugates& c) noexcept;

}  // namespace petzval::inline v0::focus_detail
