// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "petzval/core/ray.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/pupil/pupil_plane.hpp"

namespace petzval::inline v0::pupil_detail {

/// How near a ray comes to a rim.
struct Clearance {
  /// The least of 1 - r^2 / R^2 over the rims (R their semi-diameters; of r^2 / R^2 - i^2 / R^2 at central obscurations
  /// of radius i): continuous, 0 at a rim, negative for rays that a rim or obscuration stops, and lower the earlier a
  /// surface loses them otherwise.
  double value = -1;
  int surface = -1;  ///< with the least value, or the one that loses the ray otherwise
  RayFate fate = RayFate::transmitted;

  bool passes() const noexcept { return value >= 0; }
};

/// Of the ray through (x, y) of the plane. It passes exactly when `trace` transmits it.
Clearance clearance(const Lens& lens, const PupilPlane& plane, double x, double y, std::size_t wavelength) noexcept;

}  // namespace petzval::inline v0::pupil_detail
