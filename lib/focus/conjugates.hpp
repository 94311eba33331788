// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/focus/focus.hpp"
#include "petzval/paraxial/first_order.hpp"

namespace petzval::detail {

/// Newton's form of the paraxial conjugates: a subject p in front of the front focal point has its image product / p
/// behind the rear one. p is positive for every subject that can be focused.
struct Conjugates {
  double front_focal_z, rear_focal_z;
  double product;  ///< n n' f^2; negative where light leaves backwards
  double last_z;   ///< the film lies behind it, as light runs
  double sense;    ///< +1, or -1 where light leaves backwards

  double subject_z(double p) const noexcept { return front_focal_z - p; }
  double film_z(double p) const noexcept { return rear_focal_z + product / p; }
};

/// Of the lens itself (paraxial), or of the thin lens of its focal length at its rear principal plane (thin).
Conjugates conjugates(const Lens& lens, const FirstOrder& data, FocusCriterion criterion);

/// The least p in question: the subject in front of the lens and, where the distance counts from the film, beyond the
/// turning point at which subject and film are as near to each other as they can be.
double nearest_p(const Conjugates& c, DistanceOrigin origin) noexcept;

/// distance: > 0 or infinite.
FocusSolution solve(const Conjugates& c, double distance, DistanceOrigin origin);

/// Exact by the least blur of rays. start: the paraxial conjugates, from which the search begins.
FocusSolution solve_min_rms(const Lens& lens, const Conjugates& start, double distance, DistanceOrigin origin,
                            std::size_t wavelength);

}  // namespace petzval::detail
