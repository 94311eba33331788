// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "petzval/psf/spot.hpp"

namespace petzval::inline v0::psf_detail {

/// Coordinates of film points, N each, mm, and their weights, or none.
struct Points {
  std::span<const double> x, y, weights{};
};

/// spot_size() of all points of several sets.
SpotSize spot_size(std::span<const Points> sets) noexcept;

/// Where the chief ray of a point meets the film, x and y, mm; clear apertures do not stop it. Nothing where no such
/// ray reaches the film.
std::optional<Vec2<double>> chief_point(const Lens& lens, const FieldPoint& point, std::size_t wavelength);

}  // namespace petzval::inline v0::psf_detail
