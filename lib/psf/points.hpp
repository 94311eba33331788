// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "petzval/psf/spot.hpp"

namespace petzval::inline v0::psf_detail {

/// Coordinates of film points, N each, mm, and their weights, or none.
struct Points {
  std::span<const double> x, y, weights{};
};

/// spot_size() of all points of several sets.
SpotSize spot_size(std::span<const Points> sets) noexcept;

}  // namespace petzval::inline v0::psf_detail
