// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "petzval/lens/lens.hpp"

namespace petzval::inline v0::lint_detail {

/// The height of the equator of a surface's conic; infinite for a paraboloid, a hyperboloid and a plane.
double domain(const LensSurface& surface);

/// Where two neighbouring surfaces come closest.
struct Gap {
  double width;   ///< mm along the axis, positive in the direction of light
  double height;  ///< from the axis, mm
};

/// The least gap behind a surface within both clear apertures; nothing if one of them is unlimited or they have no
/// height in common.
std::optional<Gap> least_gap(const Lens& lens, std::size_t surface);

}  // namespace petzval::inline v0::lint_detail
