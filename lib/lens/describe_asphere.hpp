// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lens/asphere.hpp"
#include "petzval/lens/lens.hpp"

namespace petzval::lens_detail {

kernel::Quadric<double> describe_quadric(const LensSurface& surface);

/// Where the rim of an asphere ends: at its semi-diameter, or before it at the equator of the base conic or where it is
/// as steep as 4. Farther out it is not described.
double described_height(const LensSurface& surface);

/// The shapes of the surfaces with aspheric terms, with bounds of their rings.
std::vector<kernel::Asphere<double>> describe_aspheres(std::span<const LensSurface> surfaces);

}  // namespace petzval::lens_detail
