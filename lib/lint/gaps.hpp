// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "petzval/lens/lens.hpp"

namespace petzval::inline v0::lint_detail {

/// The height up to which the conic under a surface exists; infinite for a paraboloid, a hyperboloid and a plane.
double domain(const LensSurface& surface);

/// Where two neighbouring surfaces come closest.
struct Gap {
  double width;   ///< along the axis, positive as light runs, mm
  double height;  ///< from the axis, mm
};

/// The least gap behind a surface within both clear apertures; none where one of them is unlimited or they have no
/// height in common.
std::optional<Gap> least_gap(const Lens& lens, std::size_t surface);

}  // namespace petzval::inline v0::lint_detail
