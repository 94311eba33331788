// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/film.hpp"

namespace petzval::testing {

/// A film given by position and angles only.
inline Film film_at(double z, double tilt_rad = 0, double swing_rad = 0) {
  return {.z_mm = z, .tilt_rad = tilt_rad, .swing_rad = swing_rad};
}

}  // namespace petzval::testing
