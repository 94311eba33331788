// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "petzval/lens/lens.hpp"

namespace petzval::analysis_detail {

/// The distance between two neighbouring surfaces where they come closest.
struct Spacing {
  double width;   ///< along the direction of light, mm; negative where they overlap
  double height;  ///< from the axis, mm
};

/// The least spacing between a surface and the stop or the next surface that changes rays, within both apertures as the
/// prescription states them. nullopt if they have no height in common, or if one of them is unlimited: then only a
/// vertex on the wrong side of a mirror is found.
std::optional<Spacing> least_spacing(const Lens& lens, std::size_t surface);

}  // namespace petzval::analysis_detail
