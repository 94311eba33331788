// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <span>

#include "petzval/analysis/spot.hpp"
#include "pupil/ray_bundle.hpp"

namespace petzval::analysis_detail {

/// Coordinates of film points, N each, mm, and their weights; weights may be empty.
struct Points {
  std::span<const double> x, y, weights{};
};

/// Half the side of an image for hits up to `farthest` from its centre, mm: 5 % more, at least 0.1 um.
inline double fitting_half_width(double farthest) noexcept { return std::max(1.05 * farthest, 1e-4); }

/// spot_size() of all points of several sets.
SpotSize spot_size(std::span<const Points> sets) noexcept;

/// Film position of the chief ray of a point, mm, not clipped by apertures. nullopt if no such ray reaches the film.
std::optional<Vec2<double>> chief_point(const Lens& lens, const FieldPoint& point, std::size_t wavelength);

/// Area of the paraxial entrance pupil at the primary wavelength, mm^2; an ellipse for cylindrical lenses.
double entrance_pupil_area(const Lens& lens);

}  // namespace petzval::analysis_detail

namespace petzval {

/// The spot size of all rays of several bundles; rays without weights count 1.
PETZVAL_API SpotSize spot_size(std::span<const RayBundle> sets) noexcept;

}  // namespace petzval
