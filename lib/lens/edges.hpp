// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "petzval/core/config.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::lens_detail {

/// Sag of a surface at (x, y) (mm), also beyond its clear aperture; NaN beyond the equator of its base conic.
PETZVAL_API double sag_of(const LensSurface& surface, double x, double y) noexcept;

/// True if rays change direction at a surface: it is a mirror, or the indices on its sides differ at one wavelength.
///
/// @param indices [wavelength * (surfaces + 1) + space]
PETZVAL_API bool changes_rays(std::span<const LensSurface> surfaces, std::span<const double> indices,
                              std::size_t surface) noexcept;

/// Limits the clear apertures of surfaces: to the given rims, to the described height of aspheres, and to the height at
/// which two surfaces of an element meet.
///
/// Light passes a surface and the next surface that changes rays (another index, or a mirror) in this order only if the
/// second surface lies behind the first. Both end at the height at which they meet, unless an aperture is smaller. A
/// ray that hits one of them below this height meets both in order, provided that the distance between the surfaces has
/// a single zero. Surfaces that touch or overlap at their vertices (thickness <= 0) are ideal and have no edge.
///
/// @param surfaces vertices, shapes and thicknesses are set; `semi_diameter` and `edge` are written
/// @param rims semi-diameter of each surface (mm); infinite if unlimited
/// @param indices [wavelength * (surfaces + 1) + space]
/// @param meet false to ignore that surfaces meet, as other programs do
void end_at_edges(std::span<LensSurface> surfaces, std::span<const double> rims, std::span<const double> indices,
                  bool meet = true);

/// The lens with surfaces that reach their rims, even behind a surface that they meet.
PETZVAL_API Lens without_edges(const Lens& lens);

}  // namespace petzval::lens_detail
