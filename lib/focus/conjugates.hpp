// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/ideal_lens.hpp"

namespace petzval::focus_detail {

/// Subject and film as axial conjugates of an ideal lens, and the origin of distances. p is the distance of the subject
/// from the front focal point, towards the scene; it is positive for every subject that can be focused.
///
/// Searches use the vergence of the subject, its inverse distance to near_z. The vergence is continuous at infinity,
/// and for equal vergences the paraxial and the exact film nearly coincide.
struct Conjugates {
  /// The criterion `thin` replaces the lens by its thin equivalent; distances from the front principal plane still
  /// refer to the thick lens.
  /// @param lens the thick lens
  /// @param pupil_z z of the entrance pupil, for DistanceOrigin::entrance_pupil
  Conjugates(const IdealLens& lens, FocusCriterion criterion, DistanceOrigin origin, double pupil_z) noexcept;
  Conjugates() = default;

  IdealLens lens;
  double direction = 1;  ///< 1 or -1: direction of light behind the lens along z; films lie on that side of lens.rear_z
  DistanceOrigin origin = DistanceOrigin::front_vertex;
  double origin_z = 0;        ///< origin of distances; not used with DistanceOrigin::film
  double focal_distance = 0;  ///< from origin_z to the front focal point
  double near_z = 0;          ///< behind every subject by a focal length or more

  double subject_z(double p) const noexcept { return lens.front_focal_z - p; }
  double film_z(double p) const noexcept { return lens.rear_focal_z + lens.product() / p; }
  double distance(double subject_z, double film_z) const noexcept {
    return (origin == DistanceOrigin::film ? film_z : origin_z) - subject_z;
  }
  /// True if a film at film_z receives a real image.
  bool real(double film_z) const noexcept;

  double vergence(double subject_z) const noexcept { return 1 / (near_z - subject_z); }
  double subject_at(double vergence) const noexcept { return near_z - 1 / vergence; }
  double vergence_of_vertex() const noexcept { return 1 / near_z; }

  /// Vergence of the subject whose paraxial image lies on a film. It stays continuous when the film moves to infinity
  /// (vergence_of_infinite_film) and then comes back from in front of the lens.
  double vergence_of_film(double film_z) const noexcept;
  double vergence_of_infinite_film() const noexcept { return 1 / (near_z - lens.front_focal_z); }
};

/// The least p that can be focused. The subject must lie in front of the lens and, if distances are measured from the
/// film, beyond the turning point, at which the distance between subject and film is least.
double nearest_p(const Conjugates& c) noexcept;

/// The solution if no subject has a real image.
FocusSolution no_focus(const Conjugates& c) noexcept;

// Paraxial solvers. `distance` must be positive and may be infinite.
FocusSolution paraxial_focus(const Conjugates& c, double distance) noexcept;
FocusSolution paraxial_subject(const Conjugates& c, double film_z) noexcept;
FocusSolution paraxial_nearest(const Conjugates& c) noexcept;

}  // namespace petzval::focus_detail
