// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "petzval/core/error.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/prescription/prescription.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval::testing {

/// Image height of the declared field, which is limited to 60 degrees.
inline double declared_radius(const Prescription& p, const Lens& lens) {
  const double field = radians(std::min(p.half_field_deg.value_or(10.0), 60.0));
  try {
    const auto& [origin, direction] = chief_ray(lens, {field, -std::numeric_limits<double>::infinity()}).end.ray;
    const double t = (lens.film_z() - origin.z) / direction.z;
    return std::hypot(origin.x + t * direction.x, origin.y + t * direction.y);
  } catch (const Error&) {
    return std::abs(first_order(lens).effective_focal_length) * std::tan(std::min(field, 0.5));
  }
}

}  // namespace petzval::testing
