// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval::focus_detail {

/// Subject and film as axial conjugates of an ideal lens, and where distances count from. A subject is p in front of
/// the front focal point; p is positive for every subject that can be focused.
///
/// Searches run over the vergence of the subject, its inverse distance to near_z: a scale without a seam at infinity,
/// along which the paraxial film is nearly the exact one.
struct Conjugates {
  /// lens: thick. `thin` puts the thin lens in its place; distances from the front principal plane stay those of the
  /// thick lens. pupil_z: entrance pupil, used by the origin of that name.
  Conjugates(const IdealLens& lens, FocusCriterion criterion, DistanceOrigin origin, double pupil_z) noexcept;
  Conjugates() = default;

  IdealLens lens;
  double direction = 1;  ///< of light behind the lens along z, 1 or -1; films lie on that side of lens.rear_z
  DistanceOrigin origin = DistanceOrigin::front_vertex;
  double origin_z = 0;        ///< where distances begin; not used for those from the film
  double focal_distance = 0;  ///< from there to the front focal point
  double near_z = 0;          ///< behind every subject by a focal length or more

  double subject_z(double p) const noexcept { return lens.front_focal_z - p; }
  double film_z(double p) const noexcept { return lens.rear_focal_z + lens.product() / p; }
  double distance(double subject_z, double film_z) const noexcept {
    return (origin == DistanceOrigin::film ? film_z : origin_z) - subject_z;
  }
  /// Whether a film at film_z would catch a real image.
  bool real(double film_z) const noexcept;

  double vergence(double subject_z) const noexcept { return 1 / (near_z - subject_z); }
  double subject_at(double vergence) const noexcept { return near_z - 1 / vergence; }
  double vergence_of_vertex() const noexcept { return 1 / near_z; }

  /// Vergence of the subject whose paraxial image lies on a film: continuous where the film goes to infinity (at
  /// vergence_of_infinite_film) and comes back from in front of the lens.
  double vergence_of_film(double film_z) const noexcept;
  double vergence_of_infinite_film() const noexcept { return 1 / (near_z - lens.front_focal_z); }
};

/// The least p that can be focused: the subject in front of the lens and, where distances count from the film, beyond
/// the turning point at which subject and film are as near to each other as they can be.
double nearest_p(const Conjugates& c) noexcept;

/// The solution where nothing has a real image.
FocusSolution no_focus(const Conjugates& c) noexcept;

// The paraxial solvers. distance: > 0 or infinite.
FocusSolution paraxial_focus(const Conjugates& c, double distance) noexcept;
FocusSolution paraxial_subject(const Conjugates& c, double film_z) noexcept;
FocusSolution paraxial_nearest(const Conjugates& c) noexcept;

}  // namespace petzval::focus_detail
