// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "petzval/lens/lens.hpp"

namespace petzval::io_detail {

/// The smallest distance between two adjacent surfaces.
struct Spacing {
  double width;   ///< along the direction of light, mm; negative if they overlap
  double height;  ///< from the axis, mm
};

/// The least spacing between a surface and the next surface that is the stop or changes rays, up to the smaller of both
/// apertures in the prescription. nullopt if the surfaces have no height in common. If either aperture is unlimited,
/// only a vertex on the wrong side of a mirror is detected.
std::optional<Spacing> least_spacing(const Lens& lens, std::size_t surface);

}  // namespace petzval::io_detail
