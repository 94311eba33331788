// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "petzval/psf/spot.hpp"

namespace petzval::inline v0::psf_detail {

/// Coordinates of film points, N each, mm.
struct Points {
  std::span<const double> x, y;
};

/// spot_size() of all points of several sets.
SpotSize spot_size(std::span<const Points> sets) noexcept;

}  // namespace petzval::inline v0::psf_detail
